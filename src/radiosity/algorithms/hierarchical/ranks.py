"""Ranks: elements in an order of levels, in which the children of one parent lie side by side.

Values of all elements are then carried from level to level by slices, without a search for parents.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class Level:
    """The elements of one level, ranks ``begin`` to ``end``.

    Attributes:
        begin, end: ranks.
        parent: (end - begin,) int64, ranks of the parents, which never fall from one to the next.
        above: (p,) int64, those parents, each once.
        start: (p + 1,) int64, where the children of each begin in the level, and the number of children.
        share: (end - begin,) float64, the share of each element's area that counts in its parent's; None: all of it.
    """

    begin: int
    end: int
    parent: np.ndarray
    above: np.ndarray
    start: np.ndarray
    share: np.ndarray | None

    @cached_property
    def sums(self):
        """The sparse matrix that adds up children, (p, end - begin)."""
        from scipy.sparse import csr_array

        count = self.end - self.begin
        return csr_array((np.ones(count), np.arange(count), self.start), shape=(len(self.above), count))


@dataclass(frozen=True, eq=False)
class Ranks:
    """All elements by level, parents before their children. `ranked` makes it.

    Attributes:
        order: (n_elements,) int64, the element of each rank.
        rank: (n_elements,) int64, the rank of each element.
        levels: from the second one down; the first has no parents.
    """

    order: np.ndarray
    rank: np.ndarray
    levels: tuple[Level, ...]

    def push(self, values: np.ndarray) -> None:
        """Add to the values of each rank, (n_elements, k), those of all that hold it."""
        for level in self.levels:
            values[level.begin : level.end] += values.take(level.parent, axis=0)

    def pull(self, values: np.ndarray) -> None:
        """Add to the values of each rank, (n_elements, k), those of all that it holds. Sums are in the order of elements."""
        for level in reversed(self.levels):
            part = values[level.begin : level.end]
            values[level.above] += level.sums @ (part if level.share is None else part * level.share[:, None])

    def extremes(self, low: np.ndarray, high: np.ndarray) -> None:
        """Lower and raise the values of each rank, (k, n_elements), to the extremes of all that it holds."""
        for level in reversed(self.levels):
            for values, extreme in ((low, np.minimum), (high, np.maximum)):
                for band in values:
                    found = extreme.reduceat(band[level.begin : level.end], level.start[:-1])
                    band[level.above] = extreme(band[level.above], found)


def ranked(count: int, below: tuple[np.ndarray, ...], parent: np.ndarray, share: list[np.ndarray | None]) -> Ranks:
    """Return the ranks of elements.

    Args:
        count: the number of elements.
        below: the elements of each level but the first, in the order of elements.
        parent: (n_elements,) int64, the parent of each element.
        share: of each level, see `Level`.
    """
    first = np.ones(count, bool)
    for elements in below:
        first[elements] = False
    parts, rank, levels = [np.flatnonzero(first)], np.empty(count, np.int64), []
    end = len(parts[0])
    rank[parts[0]] = np.arange(end)
    for elements, shares in zip(below, share, strict=True):
        above = rank[parent[elements]]
        rows = np.argsort(above, kind="stable")
        above, begin, end = above[rows], end, end + len(elements)
        rank[elements[rows]] = np.arange(begin, end)
        starts = np.flatnonzero(np.diff(above, prepend=-1))
        ends = np.append(starts, len(above))
        levels.append(Level(begin, end, above, above[starts], ends, None if shares is None else shares[rows]))
        parts.append(elements[rows])
    return Ranks(np.concatenate(parts), rank, tuple(levels))
