"""Lines that are traced elsewhere: whoever traces which of them, the sums of what they bring are the same whole numbers."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Generic, TypeVar

L = TypeVar("L")
S = TypeVar("S")


class AbstractElsewhere(ABC, Generic[L, S]):
    """Traces lines of one kind elsewhere.

    Attributes:
        least: lines (of drawn walks: chunks) from which it pays; fewer are traced here.
        most: lines that are traced before there is a state to go on from.
        over: True where the run is to end: the lines that it was given have been traced all the same.
    """

    least: int = 0
    most: int = 1 << 32
    over: bool = False

    @abstractmethod
    def trace(self, lines: L) -> Iterator[S]:
        """Yield what all lines bring, in any order and in any pieces."""
