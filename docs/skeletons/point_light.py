"""A skeleton to copy: point lights that shine alike in all directions. A kind of light without area is one file like this.

The fraction of a light's power that leaves within a solid angle w is w / (4 pi). So a direction is uniform on the sphere: its z
is uniform in [-1, 1], and its azimuth in [0, 2 pi) (Archimedes). `tests/test_source_rows.py` shows what to test first.

    problem = Problem.of(patches, PointLights(np.array([[1.0, 2.0, 2.5]]), np.array([[40.0]])))
"""

from dataclasses import dataclass, field
from typing import Any

import drjit as dr
import numpy as np

from radiosity.device.backend import upload
from radiosity.problem.lights import AbstractPointLights
from radiosity.sampling.hemisphere import turn


@dataclass(eq=False)
class PointLights(AbstractPointLights):
    """Lights at points.

    Attributes:
        position: (n, 3) float64, m.
        power: (n, n_bands) float64, W or lm.
    """

    position: np.ndarray
    power: np.ndarray
    _point: Any = field(default=None, init=False)
    _places: Any = field(default=None, init=False)

    def prepare(self, geometry: Any) -> None:
        types = geometry.device.types
        self._point, self._places = types.Array3f, upload(types.Float, geometry.bvh.place(self.position))

    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        origin = dr.gather(self._point, self._places, light)
        z = 1 - 2 * numbers[1]
        across = dr.sqrt(dr.maximum(1 - z * z, 0))
        x, y = turn(numbers[0])
        return origin, type(origin)(x * across, y * across, z)

    def arrive(self, light: Any, point: Any, numbers: Any) -> tuple[Any, Any, Any]:
        way = dr.gather(self._point, self._places, light) - point
        square = dr.squared_norm(way)
        return way * dr.rsqrt(square), dr.sqrt(square), 1 / (4 * dr.pi * square)
