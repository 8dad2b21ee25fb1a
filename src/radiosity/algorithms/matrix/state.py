"""Counts of lines between patches."""

from dataclasses import dataclass

import numpy as np

from ...factors.counts import WORD
from ..merge_rules import added, one_after_another
from ..state import AbstractState, array, number


def _keys(layout, values: list[np.ndarray], records: list["MatrixState"]) -> np.ndarray:
    """Return the keys of all states; rows of later replicates have larger numbers."""
    before, found = 0, []
    for keys, record in zip(values, records, strict=True):
        found.append(keys + (np.uint64(before * record.sizes.rows) << WORD))
        before += record.replicates
    return np.concatenate(found)


@dataclass(frozen=True, eq=False, kw_only=True)
class MatrixState(AbstractState):
    """Sparse counts, see `PairCounts`.

    Attributes:
        reached: lines of each replicate so far.
        replicates: the number of independent runs.
        keys: (m,) uint64, ascending: row, r n + i, times 2^32 plus column.
        counts: (m,) uint32 where that suffices, else uint64, lines of each pair.
    """

    reached: int = number(int)
    replicates: int = number(int, merged=added)
    keys: np.ndarray = array("any", merged=_keys)
    counts: np.ndarray = array("any", merged=one_after_another)

    @property
    def unfinished(self) -> bool:
        return self.reached < self.quanta
