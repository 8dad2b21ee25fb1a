"""Lines of a gather that are traced elsewhere: ranges of the lines of each packet, whose sums are whole numbers."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ...device.backend import frozen, upload

Sums = tuple[list[np.ndarray], list[np.ndarray]]  # what lines bring, of each column; and lines that escaped and were lost


@dataclass(frozen=True, eq=False)
class GatherLines:
    """Lines of all packets, in all replicates.

    Attributes:
        kind: "shadow" or "cosine".
        done, counts: (packets,) lines of each patch so far, and now.
        read: of each group, the reflected radiosity of each lane, float32, or its K coefficients in a basis; None for shadow
            rays.
    """

    kind: str
    done: np.ndarray
    counts: np.ndarray
    read: list[np.ndarray] | None = None

    def total(self, sizes: np.ndarray) -> int:
        """Return their number in a replicate, for packets of these sizes."""
        return int((self.counts * sizes).sum(dtype=np.int64))

    def cut(self, parts: int) -> list["GatherLines"]:
        """Return ranges of the lines of each packet."""
        ends = [self.counts * at // parts for at in range(parts + 1)]
        return [replace(self, done=self.done + low, counts=high - low) for low, high in pairwise(ends)]


class AbstractLinesElsewhere(ABC):
    """Traces lines elsewhere.

    Attributes:
        least: lines from which it pays; fewer are traced here.
        over: True where the run is to end.
    """

    least: int = 0
    over: bool = False

    @property
    @abstractmethod
    def slices(self) -> int:
        """How many slices of lines are traced at a time."""

    @abstractmethod
    def trace(self, lines: GatherLines) -> Iterator[Sums]:
        """Yield the sums of all lines, in any order and in any pieces."""


def trace_here(lines: Any, part: GatherLines) -> Sums:
    """Return the sums of some lines.

    Args:
        lines: the `Lines` of a gather.
    """
    if part.read is None:
        return [np.array(frozen(column)) for column in lines.shadow(part.done, part.counts)], []
    read = [upload(lines.types.Float, column) for column in part.read]
    met, missed = lines.cosine(part.done, part.counts, read)
    return [np.array(frozen(column)) for column in met], [np.array(frozen(column)) for column in missed]
