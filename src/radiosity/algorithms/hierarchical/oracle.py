"""Which links are too coarse.

brightness-factor (P. Hanrahan, D. Salzman, L. Aupperle, "A rapid hierarchical radiosity algorithm", SIGGRAPH 1991): by the power
that a link carries, F B_s A_r; the error of an irradiance held constant over the receiver is at most a share of it.

error-radiance and error-power (P. Bekaert, Y. Willems, "Error control for radiosity", Eurographics Workshop on Rendering, 1996)
judge by the link's part of delta in equation 6 of the paper, at the point of the receiver where it is largest,

    rho_r (dK B_s + F max |B(y) - B_s|),

with dK the largest difference of the factor of a point of the receiver from the mean, and max |B(y) - B_s| that of a patch of the
source from its mean. Radiance norm: that; power norm: that times A_r. A receiver that reflects nothing is judged as if it
reflected all: its irradiance is asked for.
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
        levels: of all elements.
        parameters: epsilon is given to `too_coarse` apart, since rounds change it.
    """

    levels: Levels
    parameters: Hierarchical

    @property
    def by_error(self) -> bool:
        return self.parameters.refinement != "brightness-factor"

    @cached_property
    def limit(self) -> np.ndarray:
        """(n_bands,): what epsilon is a share of, W or W/m²."""
        patches = self.levels.hierarchy.patches
        if self.parameters.refinement == "error-radiance":
            return patches.emission.max(axis=0)
        return (patches.emission * patches.area[:, None]).sum(axis=0)

    @cached_property
    def weight(self) -> np.ndarray:
        """(n_elements, n_bands): the largest reflectance within each element, 1 where nothing is reflected."""
        _, high = self.levels.extremes(self.levels.hierarchy.patches.reflectance)
        return np.where((high > 0).any(axis=1, keepdims=True), high, 1.0)

    def parts(self, links: Links, radiosity: "Radiosity") -> tuple[np.ndarray, np.ndarray]:
        """(m, n_bands) W/m² each, of irradiance: what varies over the receiver (all of F B_s, for brightness-factor), and what
        varies over the source."""
        carried = links.spread[:, None] * radiosity.mean[links.source]
        if not self.by_error:
            return carried, np.zeros_like(carried)
        return carried, links.factor[:, None] * radiosity.deviation[links.source]

    def _weighted(self, links: Links, values: np.ndarray) -> np.ndarray:
        """(m,): irradiance by what of it matters, the largest of the bands, over what epsilon is a share of."""
        if self.by_error:
            values = values * self.weight[links.receiver]
        if self.parameters.refinement != "error-radiance":
            values = values * self.levels.area[links.receiver][:, None]
        return np.divide(values, self.limit, out=np.zeros_like(values), where=self.limit > 0).max(axis=1)

    def too_coarse(self, links: Links, radiosity: "Radiosity", epsilon: float) -> np.ndarray:
        """(m,) bool: judged too coarse, and not yet from patch to patch."""
        leaf, (here, there) = self.levels.is_leaf, self.parts(links, radiosity)
        return (self._weighted(links, here + there) > epsilon) & ~(leaf[links.receiver] & leaf[links.source])

    def divides_receiver(self, links: Links, radiosity: "Radiosity") -> np.ndarray:
        """(m,) bool: which end of coarse links to divide; a patch never is.

        Of brightness-factor links it is the larger one, the receiver where they are equal, as published. Of the others it is the
        one with the larger part in the error, which with as many links halves the error in our scenes: dividing the source makes
        four small errors of one, but their sum is no smaller.
        """
        leaf, area = self.levels.is_leaf, self.levels.area
        if self.by_error:
            here, there = (self._weighted(links, part) for part in self.parts(links, radiosity))
        else:
            here, there = area[links.receiver] * (1 + 1e-9), area[links.source]
        return ~leaf[links.receiver] & ((here >= there) | leaf[links.source])


@dataclass(frozen=True, eq=False)
class Radiosity:
    """Radiosity of all elements, (n_elements, n_bands) W/m² each.

    Attributes:
        mean: over the element.
        deviation: largest difference of a patch of the element from it.
    """

    mean: np.ndarray
    deviation: np.ndarray

    @staticmethod
    def of(levels: Levels, patches: np.ndarray) -> "Radiosity":
        """From radiosities of patches, (n_patches, n_bands)."""
        mean, (low, high) = levels.pull(patches), levels.extremes(patches)
        return Radiosity(mean, np.maximum(np.maximum(high - mean, mean - low), 0.0))
