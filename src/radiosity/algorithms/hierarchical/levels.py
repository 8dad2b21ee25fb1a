"""Values of all elements, carried from level to level: pushed down to the patches, and pulled up from them."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ...patches import Hierarchy, elements
from ...patches.clusters import Clusters


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

    def push(self, values: np.ndarray) -> np.ndarray:
        """Return what reaches each patch by its element and by all elements that hold it, (n_patches, n_bands).

        Args:
            values: (n_elements, n_bands) values per area, such as irradiance, of each element alone.
        """
        total = values.copy()
        for element in self.below:
            total[element] += total[self.parent[element]]
        return total[self.leaf]

    def pull(self, values: np.ndarray) -> np.ndarray:
        """Return means over elements of a value per area, (n_elements, n_bands).

        Args:
            values: (n_patches, n_bands).
        """
        power = np.zeros((len(self.area), values.shape[1]))
        power[self.leaf] = values * self.area[self.leaf, None]
        for element in reversed(self.below):
            self._add(power, element)
        return power / self.area[:, None]

    def _add(self, power: np.ndarray, element: np.ndarray) -> None:
        parent = self.parent[element]
        for band in power.T:  # a view: sums of columns, in the order of elements
            band += np.bincount(parent, weights=band[element] * self._solid(element), minlength=len(band))

    def _solid(self, element: np.ndarray) -> np.ndarray | float:
        """Return the share of elements that is solid where they are sides below clusters, and 1 elsewhere."""
        if self.clusters is None or element is not self.below[len(self.clusters.below)]:
            return 1.0
        return self.clusters.side_area / self.area[element]

    def extremes(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the lowest and highest of patches' values within each element, (n_elements, n_bands) each."""
        low, high = np.full((len(self.area), values.shape[1]), np.inf), np.full((len(self.area), values.shape[1]), -np.inf)
        low[self.leaf] = high[self.leaf] = values
        for element in reversed(self.below):
            parent = self.parent[element]
            np.minimum.at(low, parent, low[element])
            np.maximum.at(high, parent, high[element])
        return low, high
