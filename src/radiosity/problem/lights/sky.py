"""The sky: the radiance of lines that leave the scene, and rows that fire lines from it.

A line's direction is drawn in proportion to the radiance that lines see (`Directions`), and its origin is uniform on the disc
of the scene's ball across it. Bands in proportion share a row. Other bands have rows of their own, whose power in all others is
zero: no line then carries a weight that depends on its direction.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ...scene.lights.sky import Sky
from .ball import Ball
from .base import AbstractSky
from .directions import Directions

SAME = 1e-12  # relative: bands of one shape are in proportion


@dataclass(eq=False)
class SkyRows(AbstractSky):
    """A sky as rows: one for each set of bands that are in proportion.

    Attributes:
        sky: its values.
        n_bands: of the scene; a sky of one band has the same radiance in all of them.
        ball: about the scene.
    """

    sky: Sky
    n_bands: int
    ball: Ball
    _ball: Any = field(default=None, init=False)

    @cached_property
    def seen(self) -> Directions:
        """Radiance, a table for each band of the sky."""
        return Directions(np.moveaxis(self.sky.radiance, 2, 0), self.sky.axes)

    @cached_property
    def fired(self) -> Directions:
        """Radiance, a table for each row."""
        same = self.leaders == list(range(self.sky.radiance.shape[2]))
        return self.seen if same else Directions(self.seen.values[self.leaders], self.sky.axes)

    @cached_property
    def leaders(self) -> list[int]:
        """The band of the table that each row's directions follow."""
        return list(dict.fromkeys(leader for leader, _ in self._shapes if leader is not None))

    @cached_property
    def _shapes(self) -> list[tuple[int | None, float]]:
        """The first band that each band of the table is in proportion to, and the ratio; None: it is black."""
        found: list[tuple[int | None, float]] = []
        table, whole = self.sky.radiance, self.sky.flux
        for band in range(table.shape[2]):
            for leader in dict.fromkeys(one for one, _ in found if one is not None):
                ratio = whole[band] / whole[leader]
                if whole[band] > 0 and np.allclose(table[..., band], ratio * table[..., leader], rtol=SAME, atol=0):
                    found.append((leader, ratio))
                    break
            else:
                found.append((band, 1.0) if whole[band] > 0 else (None, 0.0))
        return found

    def of_bands(self, power: np.ndarray) -> np.ndarray:
        """Return the power of rows in each band of the scene, (n_rows, n_bands), from that in the band each row follows."""
        result = np.zeros((len(self.leaders), len(self._shapes)))
        for band, (leader, ratio) in enumerate(self._shapes):
            if leader is not None:
                row = self.leaders.index(leader)
                result[row, band] = power[row] * ratio
        return np.broadcast_to(result, (len(result), self.n_bands)).copy()

    @cached_property
    def power(self) -> np.ndarray:
        return self.of_bands(self.sky.flux[self.leaders] * self.ball.disc)

    def prepare(self, geometry: Any) -> None:
        self._ball = self.ball.placed(geometry)
        self.seen.prepare(geometry.device.types)
        self.fired.prepare(geometry.device.types)

    def radiance(self, direction: Any) -> list[Any]:
        place = self.seen.place(direction)
        bands = [self.seen.value(band, place) for band in range(len(self.seen.values))]
        return bands * (self.n_bands if len(bands) == 1 else 1)

    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        return self.leave_where(light, numbers, True)

    def leave_where(self, light: Any, numbers: Any, active: Any) -> tuple[Any, Any]:
        towards, _ = self.fired.draw(light, numbers[0], numbers[1], active)
        return self._ball.enter(-towards, numbers[2], numbers[3]), -towards
