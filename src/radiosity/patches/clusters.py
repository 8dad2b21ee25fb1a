"""Clusters: a tree above the radiating sides of a scene, whose inner nodes are groups of sides near each other.

Clusters have numbers after those of all elements (`Hierarchy`), parents before their children. Each holds a contiguous range of
`order`. Groups are halved at the median of their longest extent; a few sides that are large for their group hang on it directly.
Below the first cluster none holds both sides that emit and sides that do not: lamps are small and bright, and few of many sides.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from . import elements
from .hierarchy import Hierarchy

LEAF = 4  # sides: smaller groups are not halved
ATTACHED = 8  # sides: most that hang on a group because they are large
LARGE = 0.5  # of a group's longest extent: the radius of large sides


@dataclass(frozen=True, eq=False)
class Clusters:
    """The tree. `grow` makes it.

    Attributes:
        hierarchy: the elements below.
        order: (n_sides,) int64, sides in the order of the tree.
        begin, end: (n_clusters,) int64, the range of ``order`` that each cluster holds.
        parent: (n_clusters,) int64, a cluster's number among clusters, -1 for the first one.
        depth: (n_clusters,) int64, 0 for the first one; it never falls from one to the next.
        side_parent: (n_sides,) int64, the cluster that each side hangs on directly.
    """

    hierarchy: Hierarchy
    order: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    parent: np.ndarray
    depth: np.ndarray
    side_parent: np.ndarray

    def __len__(self) -> int:
        return len(self.begin)

    @cached_property
    def corners(self) -> np.ndarray:
        """Corners of whole sides, (n_sides, 4, 3) float64, metres."""
        return elements.corners(self.hierarchy, self.hierarchy.first[:-1])

    @cached_property
    def middle(self) -> np.ndarray:
        """Means of the corners of whole sides, (n_sides, 3) float64, metres."""
        return self.corners.mean(axis=1)

    @cached_property
    def normal(self) -> np.ndarray:
        """Unit normals of whole sides, (n_sides, 3) float64."""
        return elements.normal(self.hierarchy, self.hierarchy.first[:-1])

    @cached_property
    def side_area(self) -> np.ndarray:
        """The area of each side, (n_sides,) float64, m²; of panes the solid part (`Patches.solid`)."""
        patches, face = self.hierarchy.patches, self.hierarchy.side_face
        whole = patches.scene.area[face]
        return whole if patches.pane_of is None else whole * (1 - patches.transmittance[self.hierarchy.side_patch])

    @cached_property
    def area(self) -> np.ndarray:
        """The sum of the areas of each cluster's sides, (n_clusters,) float64, m²."""
        return self._sums(self.side_area[:, None])[:, 0]

    @cached_property
    def moments(self) -> tuple[np.ndarray, np.ndarray]:
        """Sums of area times n and of area times n nᵀ over sides with normals n, (n_clusters, 3) and (n_clusters, 3, 3), m²."""
        first = self.side_area[:, None] * self.normal
        second = (first[:, :, None] * self.normal[:, None, :]).reshape(-1, 9)
        return self._sums(first), self._sums(second).reshape(-1, 3, 3)

    @cached_property
    def spheres(self) -> tuple[np.ndarray, np.ndarray]:
        """Centres and radii of spheres that hold the clusters, (n_clusters, 3) and (n_clusters,) float64, metres."""
        low, high = np.full((len(self), 3), np.inf), np.full((len(self), 3), -np.inf)
        np.minimum.at(low, self.side_parent, self.corners.min(axis=1))
        np.maximum.at(high, self.side_parent, self.corners.max(axis=1))
        for some in reversed(self.below):
            np.minimum.at(low, self.parent[some], low[some])
            np.maximum.at(high, self.parent[some], high[some])
        centre, square = (low + high) / 2, np.zeros(len(self))
        side, cluster = np.arange(len(self.order)), self.side_parent
        while len(side):
            apart = ((self.corners[side] - centre[cluster][:, None]) ** 2).sum(axis=2).max(axis=1)
            np.maximum.at(square, cluster, apart)
            side, cluster = side[self.parent[cluster] >= 0], self.parent[cluster][self.parent[cluster] >= 0]
        return centre, np.sqrt(square)

    @cached_property
    def below(self) -> tuple[np.ndarray, ...]:
        """The clusters of depth 1, of depth 2 and so on."""
        ends = np.cumsum(np.bincount(self.depth))
        return tuple(np.arange(begin, end) for begin, end in pairwise(ends))

    @cached_property
    def children(self) -> tuple[np.ndarray, np.ndarray]:
        """The children of clusters by their element numbers, and where each cluster's begin, (n,) and (n_clusters + 1,) int64."""
        count = len(self.hierarchy)
        parent = np.concatenate([self.parent[1:], self.side_parent])
        child = np.concatenate([np.arange(1, len(self)) + count, self.hierarchy.first[:-1]])
        rows = np.argsort(parent, kind="stable")
        return child[rows], np.searchsorted(parent[rows], np.arange(len(self) + 1))

    @cached_property
    def place(self) -> np.ndarray:
        """The place of each side in ``order``, (n_sides,) int64."""
        place = np.empty(len(self.order), np.int64)
        place[self.order] = np.arange(len(self.order))
        return place

    @cached_property
    def reach(self) -> np.ndarray:
        """Areas of sides summed along ``order``, (n_sides + 1,) float64, m²."""
        return self.summed(self.side_area)

    def summed(self, values: np.ndarray) -> np.ndarray:
        """Return values of sides, (n_sides,), summed along ``order``, (n_sides + 1,) float64; `drawn` takes such sums."""
        return np.concatenate([[0], np.cumsum(values[self.order])])

    def drawn(self, cluster: np.ndarray, number: np.ndarray, reach: np.ndarray | None = None) -> np.ndarray:
        """Return sides of clusters, drawn by numbers in [0, 1), both of one shape.

        Args:
            reach: sums along ``order`` of what sides are drawn in proportion to, (n_sides + 1,); None: their areas.
        """
        begin, end = self.begin[cluster], self.end[cluster]
        reach = self.reach if reach is None else reach
        place = reach[begin] + number * (reach[end] - reach[begin])
        return self.order[np.clip(np.searchsorted(reach, place, side="right") - 1, begin, end - 1)]

    def _sums(self, values: np.ndarray) -> np.ndarray:
        """Return sums over the sides of clusters, (n_clusters, k), of values (n_sides, k)."""
        total = np.zeros((len(self), values.shape[1]))
        np.add.at(total, self.side_parent, values)
        for some in reversed(self.below):
            np.add.at(total, self.parent[some], total[some])
        return total


def grow(hierarchy: Hierarchy) -> Clusters:
    """Return the clusters of all radiating sides."""
    corners = elements.corners(hierarchy, hierarchy.first[:-1])
    middle = corners.mean(axis=1)
    radius = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    n = len(middle)
    emits = _emitting(hierarchy)
    order, side_parent = np.arange(n), np.zeros(n, np.int64)
    place, segment, parent = np.arange(n), np.zeros(n, np.int64), np.array([-1])
    begin, end, parents, depths = [], [], [], []
    count = depth = 0
    while len(place):
        starts = np.flatnonzero(np.diff(segment, prepend=-1))
        sizes = np.diff(starts, append=len(segment))
        begin.append(place[starts])
        end.append(place[starts] + sizes)
        parents.append(parent)
        depths.append(np.full(len(starts), depth))
        group, rows = _grouped(middle[order[place]], radius[order[place]], segment, starts, sizes)
        if depth == 0:  # lamps are apart from what they outshine
            lamp = emits[order[place]][rows]
            again = np.lexsort((group, np.where(group < 0, -1, lamp)))
            group, rows = np.where(group < 0, -1, lamp)[again], rows[again]
        order[place] = order[place][rows]
        hangs = group < 0
        side_parent[order[place[hangs]]] = count + segment[hangs]
        place, pair = place[~hangs], 2 * segment[~hangs] + group[~hangs]
        new = np.diff(pair, prepend=-1) != 0
        parent, segment = count + (pair[new] >> 1), np.cumsum(new) - 1
        count, depth = count + len(starts), depth + 1
    first, last, above, deep = (np.concatenate(part) for part in (begin, end, parents, depths))
    return Clusters(hierarchy, order, first, last, above, deep, side_parent)


def _emitting(hierarchy: Hierarchy) -> np.ndarray:
    """Return which sides emit, (n_sides,) bool: some patch of them does."""
    emits = (hierarchy.patches.emission > 0).any(axis=1)
    return np.logical_or.reduceat(emits, hierarchy.side_patch)


def _grouped(middle, radius, segment, starts, sizes) -> tuple[np.ndarray, np.ndarray]:
    """Return the groups of sides in their new order (-1 hangs on the cluster itself, 0 and 1 are its halves), and that order."""
    extent = np.maximum.reduceat(middle, starts) - np.minimum.reduceat(middle, starts)
    longest, axis = extent.max(axis=1), extent.argmax(axis=1)
    large = radius > LARGE * longest[segment]
    n_large = np.add.reduceat(large.astype(np.int64), starts)
    small = (sizes <= LEAF) | (sizes - n_large <= LEAF) & (n_large <= ATTACHED)
    attached = small[segment] | (large & (n_large <= ATTACHED)[segment])
    apart = (~small & (n_large > ATTACHED) & (n_large < sizes))[segment]
    along = np.take_along_axis(middle, axis[segment][:, None], axis=1)[:, 0]
    rows = np.lexsort((along, ~attached, segment))
    rest = sizes - np.add.reduceat(attached.astype(np.int64), starts)
    rank = np.arange(len(rows)) - (starts + sizes - rest)[segment]  # in each segment those that hang on it come first
    half = (rank >= (rest // 2)[segment]).astype(np.int64)
    group = np.where(attached[rows], -1, np.where(apart, (~large[rows]).astype(np.int64), half))
    again = np.lexsort((group, segment))
    return group[again], rows[again]
