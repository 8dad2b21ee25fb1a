"""Values of all elements, carried from level to level: pushed down to the patches, and pulled up from them."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ...patches import Hierarchy, elements
from ...patches.clusters import Clusters
from .ranks import Ranks, ranked


@dataclass(frozen=True, eq=False)
class Levels:
    """Facts of elements, and of clusters after them, that are needed often, as arrays over all of both.

    Attributes:
        hierarchy: the hierarchy of the elements.
        clusters: clusters above the elements; None where there are none, and whole sides are at the top.
    """

    hierarchy: Hierarchy
    clusters: Clusters | None = None

    @cached_property
    def _every(self) -> np.ndarray:
        return np.arange(len(self.hierarchy))

    @cached_property
    def parent(self) -> np.ndarray:
        """The parent of each element, (n_elements,) int64, -1 for roots."""
        parent = self.hierarchy.parent(self._every)
        if self.clusters is None:
            return parent
        parent[self.hierarchy.first[:-1]] = self.clusters.side_parent + len(parent)
        return np.concatenate([parent, np.where(self.clusters.parent < 0, -1, self.clusters.parent + len(parent))])

    @cached_property
    def area(self) -> np.ndarray:
        """The area of each element, (n_elements,) float64, m²; of clusters that of the solid parts of all their sides."""
        area = elements.area(self.hierarchy, self._every)
        return area if self.clusters is None else np.concatenate([area, self.clusters.area])

    @cached_property
    def size(self) -> np.ndarray:
        """The square of each element's radius, (n_elements,) float64, m²: about what it covers of a view."""
        corners = elements.corners(self.hierarchy, self._every)
        square = ((corners - corners.mean(axis=1, keepdims=True)) ** 2).sum(axis=2).max(axis=1)
        return square if self.clusters is None else np.concatenate([square, self.clusters.spheres[1] ** 2])

    @cached_property
    def is_leaf(self) -> np.ndarray:
        """True where an element is a patch, (n_elements,) bool."""
        leaf = self.hierarchy.is_leaf(self._every)
        return leaf if self.clusters is None else np.concatenate([leaf, np.zeros(len(self.clusters), bool)])

    @cached_property
    def leaf(self) -> np.ndarray:
        """The element that each patch is, (n_patches,) int64."""
        return self.hierarchy.leaf(np.arange(len(self.hierarchy.patches)))

    @cached_property
    def below(self) -> tuple[np.ndarray, ...]:
        """The elements of level 1, of level 2 and so on; before them clusters by their depth, and whole sides."""
        level = self.hierarchy.level(self._every)
        order = np.argsort(level, kind="stable")
        ends = np.cumsum(np.bincount(level))
        within = tuple(order[begin:end] for begin, end in pairwise(ends))
        if self.clusters is None:
            return within
        return *(some + len(level) for some in self.clusters.below), self.hierarchy.first[:-1], *within

    @cached_property
    def ranks(self) -> Ranks:
        """All elements by level."""
        share: list[np.ndarray | None] = [None] * len(self.below)
        if self.clusters is not None:  # of sides below clusters their solid part counts
            share[len(self.clusters.below)] = self.clusters.side_area / self.area[self.hierarchy.first[:-1]]
        return ranked(len(self.area), self.below, self.parent, share)

    @cached_property
    def leaf_rank(self) -> np.ndarray:
        """The rank of the element that each patch is, (n_patches,) int64."""
        return self.ranks.rank[self.leaf]

    @cached_property
    def rank_area(self) -> np.ndarray:
        """The area of the element of each rank, (n_elements, 1) float64, m²."""
        return self.area[self.ranks.order][:, None]

    def push(self, values: np.ndarray) -> np.ndarray:
        """Return what reaches each patch by its element and by all elements that hold it, (n_patches, n_bands).

        Args:
            values: (n_elements, n_bands) values per area, such as irradiance, of each element alone.
        """
        return self.push_ranks(values[self.ranks.order])

    def push_ranks(self, values: np.ndarray) -> np.ndarray:
        """Do as `push` does with values by rank, which are overwritten."""
        self.ranks.push(values)
        return values.take(self.leaf_rank, axis=0)

    def pull(self, values: np.ndarray) -> np.ndarray:
        """Return means over elements of a value per area, (n_elements, n_bands).

        Args:
            values: (n_patches, n_bands).
        """
        return self.pull_ranks(values)[self.ranks.rank]

    def pull_ranks(self, values: np.ndarray) -> np.ndarray:
        """Do as `pull` does, with means by rank."""
        power = np.zeros((len(self.area), values.shape[1]))
        power[self.leaf_rank] = values * self.area[self.leaf, None]  # whole areas: factors count the solid part of panes
        self.ranks.pull(power)
        return power / self.rank_area

    def extremes(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the lowest and highest of patches' values within each element, (n_elements, n_bands) each."""
        shape = values.shape[1], len(self.area)
        low, high = np.full(shape, np.inf), np.full(shape, -np.inf)
        low[:, self.leaf_rank] = high[:, self.leaf_rank] = values.T
        self.ranks.extremes(low, high)
        return tuple(np.ascontiguousarray(found[:, self.ranks.rank].T) for found in (low, high))  # type: ignore[return-value]
