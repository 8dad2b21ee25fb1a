"""Values of all elements, carried from level to level: pushed down to the patches, and pulled up from them."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ...patches import Hierarchy, elements


@dataclass(frozen=True, eq=False)
class Levels:
    """Facts of elements that are needed often, as arrays over all elements.

    Attributes:
        hierarchy: the hierarchy of the elements.
    """

    hierarchy: Hierarchy

    @cached_property
    def _every(self) -> np.ndarray:
        return np.arange(len(self.hierarchy))

    @cached_property
    def parent(self) -> np.ndarray:
        """The parent of each element, (n_elements,) int64, -1 for roots."""
        return self.hierarchy.parent(self._every)

    @cached_property
    def area(self) -> np.ndarray:
        """The area of each element, (n_elements,) float64, m²."""
        return elements.area(self.hierarchy, self._every)

    @cached_property
    def is_leaf(self) -> np.ndarray:
        """True where an element is a patch, (n_elements,) bool."""
        return self.hierarchy.is_leaf(self._every)

    @cached_property
    def leaf(self) -> np.ndarray:
        """The element that each patch is, (n_patches,) int64."""
        return self.hierarchy.leaf(np.arange(len(self.hierarchy.patches)))

    @cached_property
    def below(self) -> tuple[np.ndarray, ...]:
        """The elements of level 1, of level 2 and so on."""
        level = self.hierarchy.level(self._every)
        order = np.argsort(level, kind="stable")
        ends = np.cumsum(np.bincount(level))
        return tuple(order[begin:end] for begin, end in pairwise(ends))

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
            band += np.bincount(parent, weights=band[element], minlength=len(band))

    def extremes(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the lowest and highest of patches' values within each element, (n_elements, n_bands) each."""
        low, high = np.full((len(self.area), values.shape[1]), np.inf), np.full((len(self.area), values.shape[1]), -np.inf)
        low[self.leaf] = high[self.leaf] = values
        for element in reversed(self.below):
            parent = self.parent[element]
            np.minimum.at(low, parent, low[element])
            np.maximum.at(high, parent, high[element])
        return low, high
