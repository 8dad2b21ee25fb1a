"""Oracles, which decide which links are too coarse.

brightness-factor (P. Hanrahan, D. Salzman, L. Aupperle, "A rapid hierarchical radiosity algorithm", SIGGRAPH 1991) judges by the
power that a link carries, F B_s A_r; the error of an irradiance held constant over the receiver is at most a share of it.

error-radiance and error-power (P. Bekaert, Y. Willems, "Error control for radiosity", Eurographics Workshop on Rendering, 1996)
judge by the link's part of delta in equation 6 of the paper, at the point of the receiver where it is largest,

    rho_r (dK B_s + F max |B(y) - B_s|),

with dK the largest difference of the factor of a point of the receiver from the mean, and max |B(y) - B_s| the largest difference
of a patch of the source from its mean. This is the radiance norm; the power norm is this times A_r. A receiver that reflects
nothing is judged as if it reflected all, since its irradiance is a result, too.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .levels import Levels
from .links import Links
from .parameters import Hierarchical


@dataclass(frozen=True, eq=False)
class Oracle:
    """Judges links.

    Attributes:
        levels: the values of all elements.
        parameters: the parameters; `too_coarse` takes epsilon as an argument, since rounds change it.
    """

    levels: Levels
    parameters: Hierarchical

    @property
    def by_error(self) -> bool:
        return self.parameters.refinement != "brightness-factor"

    @cached_property
    def limit(self) -> np.ndarray:
        """The power or radiosity that epsilon is a share of, (n_bands,) W or W/m²."""
        patches = self.levels.hierarchy.patches
        if self.parameters.refinement == "error-radiance":
            return patches.emission.max(axis=0)
        return (patches.emission * patches.area[:, None]).sum(axis=0)

    @cached_property
    def weight(self) -> np.ndarray:
        """The largest reflectance within each element, 1 where nothing is reflected, (n_elements, n_bands)."""
        _, high = self.levels.extremes(self.levels.hierarchy.patches.reflectance)
        return np.where((high > 0).any(axis=1, keepdims=True), high, 1.0)

    def parts(self, links: Links, radiosity: "Radiosity") -> tuple[np.ndarray, np.ndarray]:
        """Return the parts of an irradiance that vary over the receiver and over the source, (m, n_bands) W/m² each.

        For brightness-factor the first is all of F B_s.
        """
        carried = links.spread[:, None] * radiosity.mean[links.source]
        if not self.by_error:
            return carried, np.zeros_like(carried)
        return carried, links.factor[:, None] * radiosity.deviation[links.source]

    def _weighted(self, links: Links, values: np.ndarray) -> np.ndarray:
        """Return irradiance in the norm of the oracle, over what epsilon is a share of, the largest of the bands, (m,)."""
        if self.by_error:
            values = values * self.weight[links.receiver]
        if self.parameters.refinement != "error-radiance":
            values = values * self.levels.area[links.receiver][:, None]
        return np.divide(values, self.limit, out=np.zeros_like(values), where=self.limit > 0).max(axis=1)

    def too_coarse(self, links: Links, radiosity: "Radiosity", epsilon: float) -> np.ndarray:
        """Return which links are too coarse and not yet from patch to patch, (m,) bool."""
        leaf, (here, there) = self.levels.is_leaf, self.parts(links, radiosity)
        return (self._weighted(links, here + there) > epsilon) & ~(leaf[links.receiver] & leaf[links.source])

    def divides_receiver(self, links: Links, radiosity: "Radiosity") -> np.ndarray:
        """Return whether to divide the receiver of coarse links, or else the source, (m,) bool; a patch is never divided.

        With brightness-factor it is the larger end, the receiver where they are equal, as published. With the others it is the
        end with the larger part in the error, which with as many links halves the error in our scenes: dividing the source makes
        four small errors of one, but their sum is no smaller.
        """
        leaf, area = self.levels.is_leaf, self.levels.area
        if self.by_error:
            here, there = (self._weighted(links, part) for part in self.parts(links, radiosity))
        else:
            here, there = area[links.receiver] * (1 + 1e-9), area[links.source]
        if self.levels.clusters is not None:  # the area of a cluster says little of its size
            size, count = self.levels.size, len(self.levels.hierarchy)
            volume = np.maximum(links.receiver, links.source) >= count
            here = np.where(volume, size[links.receiver] * (1 + 1e-9), here)
            there = np.where(volume, size[links.source], there)
        return ~leaf[links.receiver] & ((here >= there) | leaf[links.source])


@dataclass(frozen=True, eq=False)
class Radiosity:
    """Radiosity of all elements, (n_elements, n_bands) W/m² each.

    Attributes:
        mean: the mean over the element.
        deviation: the largest difference of a patch of the element from the mean.
    """

    mean: np.ndarray
    deviation: np.ndarray

    @staticmethod
    def of(levels: Levels, patches: np.ndarray) -> "Radiosity":
        """Return the radiosity of elements from that of patches, (n_patches, n_bands)."""
        mean, (low, high) = levels.pull(patches), levels.extremes(patches)
        deviation = np.maximum(np.maximum(high - mean, mean - low), 0.0)
        if levels.clusters is not None:  # of many sides, bright ones are few: the mean deviation is no more than this
            count = len(levels.hierarchy)
            deviation[count:] = np.minimum(deviation[count:], 2 * mean[count:])
        return Radiosity(mean, deviation)
