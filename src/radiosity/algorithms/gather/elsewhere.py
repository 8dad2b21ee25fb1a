"""Lines of a gather that are traced elsewhere: ranges of the lines of each packet, whose sums are whole numbers."""

from abc import abstractmethod
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ...device.backend import frozen, upload
from ...tally.elsewhere import AbstractElsewhere

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


class AbstractLinesElsewhere(AbstractElsewhere[GatherLines, Sums]):
    """Traces lines of a gather elsewhere."""

    @property
    @abstractmethod
    def slices(self) -> int:
        """How many slices of lines are traced at a time."""


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
