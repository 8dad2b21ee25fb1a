"""The sky as lines of a gather see it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...problem.lights.base import AbstractSky
from ...problem.model import Problem


@dataclass(frozen=True, eq=False)
class Glow:
    """What lines see that leave the scene.

    Attributes:
        sky: the sky, prepared.
        leaders: the band of each group of bands.
        scales: what makes radiances shares of the unit of light, for each group.
    """

    sky: AbstractSky
    leaders: tuple[int, ...]
    scales: tuple[Any, ...]

    @staticmethod
    def of(sky: AbstractSky, geometry: Any, problem: Problem) -> "Glow":
        """Prepare the sky of a problem."""
        import drjit as dr

        sky.prepare(geometry)
        scales = np.pi / np.maximum(problem.unit, 1e-300)
        return Glow(sky, tuple(problem.groups.leaders.tolist()), tuple(dr.opaque(geometry.device.types.Float, x) for x in scales))

    def shares(self, direction: Any) -> list:
        """Return pi times the radiance in these directions, in shares of the unit, for each group; called in a kernel."""
        bands = self.sky.radiance(direction)
        return [bands[band] * scale for band, scale in zip(self.leaders, self.scales, strict=True)]
