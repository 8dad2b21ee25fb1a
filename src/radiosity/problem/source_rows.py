"""Source rows, which fire lines: one for each patch, and then one for each light without area."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import SceneError
from ..patches.model import Patches
from ..patches.scatter import Scatter
from .bands import BandGroups
from .quanta import Source

THROUGH = 0.5  # of all first lines go through openings, where there are any


@dataclass(frozen=True, eq=False)
class SourceRows:
    """Rows that fire lines. Patches come first, in their order; rows after them receive nothing.

    Attributes:
        n_patches: the number of rows that are patches.
        emission: (n_rows, n_groups) float64, W/m² or lm/m² of each group of bands.
        reflectance: (n_rows, n_groups) float64; lights have 0.
        area: (n_rows,) float64, m². A light without area counts as one of 1 m², which emits its power.
        lines: (n_rows,) float64, 1 or more: how many times as many lines a row fires as its power asks for, each of which carries
            less; None: 1 for all.
        through: (n_rows, n_groups) float64, diffuse transmittance; None where nothing diffuses light.
        other: (n_rows,) int64, the row on the other side of each; None where nothing diffuses light.
    """

    n_patches: int
    emission: np.ndarray
    reflectance: np.ndarray
    area: np.ndarray
    lines: np.ndarray | None = None
    through: np.ndarray | None = None
    other: np.ndarray | None = None

    @staticmethod
    def of(patches: Patches, groups: BandGroups, light_power: np.ndarray, through: np.ndarray | None = None) -> "SourceRows":
        """Make the rows of patches, and of lights from their power, (n_lights, n_groups).

        Args:
            through: (n_lights,) bool, lines through openings. They are at least `THROUGH` of all first lines.
        """
        if not len(light_power):  # the patches' own arrays, which need no copy
            return SourceRows(
                len(patches), groups.emission, groups.reflectance, patches.area, through=groups.through, other=groups.other
            )
        emission, area = np.concatenate([groups.emission, light_power]), np.append(patches.area, np.ones(len(light_power)))
        lines = None
        if through is not None and through.any():
            power, more = emission.max(axis=1) * area, np.append(np.zeros(len(patches), bool), through)
            of_others, own = power[~more].sum(), power[more].sum()
            if 0 < own < THROUGH * (own + of_others):
                lines = np.where(more, THROUGH / (1 - THROUGH) * of_others / own, 1.0)
        rho, tau, other = np.concatenate([groups.reflectance, np.zeros_like(light_power)]), groups.through, groups.other
        if tau is not None and other is not None:
            tau = np.concatenate([tau, np.zeros_like(light_power)])
            other = np.append(other, len(patches) + np.arange(len(light_power)))
        return SourceRows(len(patches), emission, rho, area, lines, tau, other)

    @property
    def n_lights(self) -> int:
        return len(self.area) - self.n_patches

    def scalar(self, patches: Patches) -> Source:
        """Return the scalar problem of the largest band of each row (contract 3).

        Raises:
            SceneError: nothing emits, or a pane's largest reflectance and largest diffuse transmittance are 1 or more together.
        """
        emission = self.emission.max(axis=1) * (1.0 if self.lines is None else self.lines)
        rho, tau = self.reflectance.max(axis=1), None if self.through is None else self.through.max(axis=1)
        if tau is not None and (rho + tau >= 1).any():
            row = int(np.argmax(rho + tau))
            name = patches.scene.names[patches.surface[row]]
            raise SceneError(
                f"{patches.scene.source}: surface '{name}' reflects up to {rho[row]:g} in one band and diffuses up to "
                f"{tau[row]:g} in another, 1 or more together: lines carry all bands; solve each band by itself"
            )
        return Source.of(patches, emission, rho, self.area, tau, self.other)

    @cached_property
    def scatter(self) -> Scatter:
        """What rows send on of the light that they receive."""
        return Scatter(self.reflectance, self.through, self.other)

    @property
    def weighed(self) -> bool:
        """True where lines carry power of their own, and do not count as whole energy packets."""
        return self.lines is not None or self.emission.shape[1] > 1
