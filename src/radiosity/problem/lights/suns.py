"""Suns: light from small discs of equal radiance, infinitely far away.

A line's direction is uniform in the solid angle W of a sun's disc, and its origin uniform on the disc of area A across it that
the scene's ball has. A sun of radiance L and half angle a gives a plane across its middle the irradiance E = pi L sin² a.
With W = 2 pi (1 - cos a), the power through the disc is L W A = E A 2 / (1 + cos a).
"""

from dataclasses import dataclass, field
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import small
from ...sampling.global_lines import across
from ...sampling.hemisphere import turn
from ...scene.lights.sun import Sun
from .ball import Ball
from .base import AbstractPointLights


@dataclass(eq=False)
class Suns(AbstractPointLights):
    """Suns, each a row.

    Attributes:
        towards: (n, 3) float64, unit directions to the middle of each sun.
        cap: (n,) float64, 1 - cos a of each.
        power: (n, n_bands) float64, W or lm through the disc of the ball.
        ball: about the scene.
    """

    towards: np.ndarray
    cap: np.ndarray
    power: np.ndarray
    ball: Ball
    _types: Any = field(default=None, init=False)
    _ball: Any = field(default=None, init=False)
    _records: Any = field(default=None, init=False)

    @staticmethod
    def of(suns: tuple[Sun, ...], n_bands: int, ball: Ball) -> "Suns":
        """Make the rows of suns, whose irradiance has as many bands as the scene, or one for all."""
        towards = np.array([sun.direction / np.linalg.norm(sun.direction) for sun in suns])
        cap = np.array([2 * np.sin(np.radians(sun.diameter) / 4) ** 2 for sun in suns])
        irradiance = np.array([np.broadcast_to(sun.irradiance, n_bands) for sun in suns])
        return Suns(towards, cap, irradiance * (ball.disc * 2 / (2 - cap))[:, None], ball)

    def prepare(self, geometry: Any) -> None:
        self._types, self._ball = geometry.device.types, self.ball.placed(geometry)
        self._records = small(self._types.Float, np.column_stack([self.towards, self.cap]))

    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        direction = -self.towards_of(light, numbers[2], numbers[3])
        return self._ball.enter(direction, numbers[0], numbers[1]), direction

    def arrive(self, light: Any, point: Any, numbers: Any) -> tuple[Any, Any, Any]:
        area = np.pi * self._ball.radius * self._ball.radius
        return self.towards_of(light, numbers[0], numbers[1]), self._types.Float(dr.inf), 1 / area

    def towards_of(self, light: Any, first: Any, second: Any) -> Any:
        """Return a direction to each sun, uniform in the solid angle of its disc."""
        types = self._types
        x, y, z, cap = (dr.gather(types.Float, self._records, light * 4 + i) for i in range(4))
        middle, less = types.Array3f(x, y, z), second * cap  # less = 1 - cos of the angle to the middle
        sine = dr.sqrt(less * (2 - less))
        cosine, other = turn(first)
        return middle * (1 - less) + across(middle, cosine * sine, other * sine)
