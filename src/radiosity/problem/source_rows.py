"""Source rows, which fire lines: one for each patch, and then one for each light without area."""

from dataclasses import dataclass

import numpy as np

from ..patches.model import Patches
from .bands import BandGroups
from .quanta import Source


@dataclass(frozen=True, eq=False)
class SourceRows:
    """Rows that fire lines. Patches come first, in their order; rows after them receive nothing.

    Attributes:
        n_patches: the number of rows that are patches.
        emission: (n_rows, n_groups) float64, W/m² or lm/m² of each group of bands.
        reflectance: (n_rows, n_groups) float64; lights have 0.
        area: (n_rows,) float64, m². A light without area counts as one of 1 m², which emits its power.
    """

    n_patches: int
    emission: np.ndarray
    reflectance: np.ndarray
    area: np.ndarray

    @staticmethod
    def of(patches: Patches, groups: BandGroups, light_power: np.ndarray) -> "SourceRows":
        """Make the rows of patches, and of lights from their power, (n_lights, n_groups)."""
        if not len(light_power):  # the patches' own arrays, which need no copy
            return SourceRows(len(patches), groups.emission, groups.reflectance, patches.area)
        return SourceRows(
            len(patches),
            np.concatenate([groups.emission, light_power]),
            np.concatenate([groups.reflectance, np.zeros_like(light_power)]),
            np.append(patches.area, np.ones(len(light_power))),
        )

    @property
    def n_lights(self) -> int:
        return len(self.area) - self.n_patches

    def scalar(self, patches: Patches) -> Source:
        """Return the scalar problem of the largest band of each row (contract 3).

        Raises:
            SceneError: nothing emits.
        """
        return Source.of(patches, self.emission.max(axis=1), self.reflectance.max(axis=1), self.area)
