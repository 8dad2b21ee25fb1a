"""The interface of number sequences."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...errors import MethodError

if TYPE_CHECKING:
    import numpy as np  # names of methods are told without it

DIMENSIONS = 5
WORDS = 8  # words of the randomisation of a scene and replicate
LARGEST = 2**32 - 1  # no index is larger in any sequence
KRONECKER = (0xE19B01AB, 0xC6D1D6C9, 0xAF36D01F, 0x9A69443F, 0x881403B9)  # g^-1 to g^-5 times 2^32, odd; g^6 = g + 1


@dataclass(frozen=True)
class AbstractNumbers(ABC):
    """Points of the five-dimensional unit cube, each a function of (index, patch, randomisation) and nothing else.

    Dimensions 1 and 2 give a line's direction, 3 and 4 its position on the patch, 5 a choice, such as absorption. A dimension
    that a kernel does not use costs nothing. Walks that need more dimensions take shuffled copies, see `shuffle`. Index 0 is
    never used.
    """

    @abstractmethod
    def randomisation(self, stream: "np.random.SeedSequence") -> "np.ndarray":
        """Return (8,) uint32 drawn on the host from a strong generator: the randomisation of a scene and replicate."""

    def of_patch(self, randomisation: list, place: Any) -> list:
        """Return the randomisation of a patch, made from that of its replicate, which is that of place 0; called in a kernel.

        Each word is moved by the place (UInt32) times a number of its own, modulo 1. That is a Kronecker sequence, with the
        numbers of M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018. A place is a sum of face, column
        and row, see `tracing.ray_generation.place_number`, chosen so that the patches of a face move a point evenly over the
        cube.
        """
        moved = [word + place * step for word, step in zip(randomisation, KRONECKER, strict=False)]
        return [*moved, *randomisation[DIMENSIONS:]]

    @abstractmethod
    def points(self, index: Any, patch: Any, randomisation: Any, bits: int) -> list[Any]:
        """Return five Dr.Jit floats in [0, 1); called in a kernel.

        Args:
            index: UInt32, 1 and up, below 2**bits and not beyond `largest`.
            patch: UInt32, the patch of the line: the key of random numbers, which low discrepancy sequences ignore.
            randomisation: eight UInt32, of the replicate or of `of_patch`.
            bits: a bound that is known when the kernel is compiled; it has few values, so that few kernels are compiled.
        """

    @abstractmethod
    def prepare(self, types: Any) -> None:
        """Make on the device what `points` reads, of Dr.Jit's array ``types``: nothing can be made while a loop is recorded."""

    def in_turn(
        self, first: Any, patch: Any, randomisation: Callable[[Any], list], bits: int, turns: int
    ) -> Callable[[Any], list[Any]]:
        """Return a function for a loop over the `points` of ``turns`` indices from ``first`` on.

        It is made before the loop, and called in it with the turn, UInt32 from 0 on. Points of indices of 2**bits and beyond are
        not defined. Here ``randomisation`` gives the words for an index.
        """
        return lambda turn: self.points(first + turn, patch, randomisation(first + turn), bits)

    @abstractmethod
    def steps(self) -> tuple[int, ...]:
        """Return the values that ``bits`` may take, increasing; the last is 32."""

    @abstractmethod
    def largest(self) -> int:
        """Return the largest index, at most 2**32 - 1."""

    def bits_for(self, largest_index: int) -> int:
        """Return the smallest step that holds an index.

        Raises:
            MethodError: the sequence has no point of this index.
        """
        if largest_index > self.largest():
            raise MethodError(
                f"{type(self).__name__} numbers end at index {self.largest()}, but a patch would fire line {largest_index}; "
                "take fewer lines a replicate, and more replicates"
            )
        return next(step for step in self.steps() if largest_index < 2**step)
