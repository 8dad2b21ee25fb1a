"""Lines through openings as rows of their own, so that random walks may send more of them (docs/daylight.md).

Lines of the sky and of suns are those whose straight path crosses an opening, whatever is in the way, and all others. `Beside`
fires the others, `SkyThrough` and `SunsThrough` the first; of several openings a line belongs to the one that it crosses first.
So which row fires a line is a function of the line: nothing is counted twice, and nothing left out. A line that a row draws, and
that belongs to another, leaves the scene at once: its power counts as sent and as escaped.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from .base import AbstractLights
from .choices import Choices
from .directions import Directions
from .opening_lines import OpeningLines
from .sky import SkyRows
from .suns import Suns

ROWS, COLUMNS = 91, 360  # at least, of the upper half of tables of radiance times cosine
PLANES = 24  # most directions that openings face with a table each; all others share one, which does not know their direction
ENTRIES = 1 << 24  # most entries of all these tables: a large image of a sky has fewer of them


@dataclass(eq=False)
class Beside(AbstractLights):
    """The lines of the sky or of suns whose straight path crosses no opening.

    Attributes:
        lights: their rows.
        openings: what the lines may cross.
    """

    lights: AbstractLights
    openings: OpeningLines

    @property
    def power(self) -> np.ndarray:
        return self.lights.power

    def prepare(self, geometry: Any) -> None:
        self.lights.prepare(geometry)
        self.openings.prepare(geometry)

    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        return self.leave_where(light, numbers, True)

    def leave_where(self, light: Any, numbers: Any, active: Any) -> tuple[Any, Any]:
        return self.openings.without(self.lights.leave_where(light, numbers, active), active)


@dataclass(eq=False)
class SkyThrough(AbstractLights):
    """The sky's lines through openings: rows for each direction that openings face, one for each row of the sky.

    Directions are drawn in proportion to a table that is nowhere below radiance times the cosine to the normal, and nowhere far
    above: in place of the cosine, each entry has its largest value in the cells around. The quotient of both is the probability
    that a line is fired.

    Attributes:
        sky: its rows.
        openings: what the lines cross.
    """

    sky: SkyRows
    openings: OpeningLines

    @cached_property
    def planes(self) -> tuple[np.ndarray, np.ndarray]:
        """The normals that have tables, (k, 3), of the largest openings, and the table of each opening, (n,); k: a common one."""
        normal = self.openings.normal.copy()
        normal *= np.sign(normal[np.arange(len(normal)), np.abs(normal).argmax(axis=1)])[:, None]
        _, first, which = np.unique(np.round(normal, 7), axis=0, return_index=True, return_inverse=True)
        order = np.argsort(-np.bincount(which.ravel(), self.openings.area), kind="stable")
        rank = np.empty(len(order), np.int64)
        rank[order] = np.arange(len(order))
        half, columns = self._size
        most = min(PLANES, ENTRIES // (2 * half * columns * len(self.sky.leaders)))
        return normal[first[order[:most]]], np.minimum(rank[which.ravel()], most)

    @property
    def _finer(self) -> tuple[int, int]:
        """How many cells stand in place of one of the sky, so that each lies within one: along elevation, and along azimuth."""
        _, rows, columns = self.sky.fired.values.shape
        return -(-(ROWS - 1) // (rows // 2 - 1)), -(-COLUMNS // columns)

    @property
    def _size(self) -> tuple[int, int]:
        """Rows of half a table, and columns."""
        _, rows, columns = self.sky.fired.values.shape
        return self._finer[0] * (rows // 2 - 1) + 1, self._finer[1] * columns

    @cached_property
    def tables(self) -> Directions:
        """A table for each plane and each row of the sky; the common ones, where there are any, have a cosine of 1."""
        normals, which = self.planes
        radiance, axes = self.sky.fired.refined(*self._finer), self.sky.sky.axes
        tables = [radiance * largest_cosine(radiance.shape[1], radiance.shape[2], axes, normal) for normal in normals]
        common = [radiance] if which.max() == len(normals) else []
        return Directions(np.concatenate(tables + common), axes)

    @cached_property
    def power(self) -> np.ndarray:
        flux = self.tables.flux.reshape(-1, len(self.sky.leaders))
        area = np.bincount(self.planes[1], self.openings.area, minlength=len(flux))
        return np.concatenate([self.sky.of_bands(row) for row in flux * area[:, None]])

    @cached_property
    def _choices(self) -> Choices:
        which = self.planes[1]
        return Choices(np.where(np.arange(which.max() + 1)[:, None] == which, self.openings.area, 0.0))

    def prepare(self, geometry: Any) -> None:
        self.sky.prepare(geometry)
        self.openings.prepare(geometry)
        self.tables.prepare(geometry.device.types)
        self._choices.prepare(geometry.device.types)

    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        return self.leave_where(light, numbers, True)

    def leave_where(self, light: Any, numbers: Any, active: Any) -> tuple[Any, Any]:
        n_sky = len(self.sky.leaders)
        plane = light // n_sky if n_sky > 1 else light
        towards, most = self.tables.draw(light, numbers[0], numbers[1], active)
        radiance = self.sky.fired.value(light - plane * n_sky, self.sky.fired.place(towards), active)
        number, rest = self._choices.draw(plane, numbers[2], active)
        return self.openings.through(
            number, (rest, numbers[3]), -towards, lambda cosine: numbers[4] * most < radiance * cosine, active
        )


@dataclass(eq=False)
class SunsThrough(AbstractLights):
    """The lines of suns through openings, a row for each sun.

    An opening is drawn in proportion to its area times the largest cosine that a direction in the sun's disc has to its normal.

    Attributes:
        suns: their rows.
        openings: what the lines cross.
    """

    suns: Suns
    openings: OpeningLines
    _most: Any = field(default=None, init=False)

    @cached_property
    def most(self) -> np.ndarray:
        """The largest cosines, (n_suns, n) float64, or a little more."""
        cap = self.suns.cap[:, None]
        return np.minimum(np.abs(self.suns.towards @ self.openings.normal.T) + np.sqrt(cap * (2 - cap)) + 1e-6, 1)

    @cached_property
    def power(self) -> np.ndarray:
        return self.suns.power * (self.most @ self.openings.area / self.suns.ball.disc)[:, None]

    @cached_property
    def _choices(self) -> Choices:
        return Choices(self.most * self.openings.area)

    def prepare(self, geometry: Any) -> None:
        self.suns.prepare(geometry)
        self.openings.prepare(geometry)
        self._choices.prepare(geometry.device.types)
        self._most = upload(geometry.device.types.Float, self.most.astype(np.float32))

    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        return self.leave_where(light, numbers, True)

    def leave_where(self, light: Any, numbers: Any, active: Any) -> tuple[Any, Any]:
        number, rest = self._choices.draw(light, numbers[0], active)
        most = dr.gather(type(rest), self._most, light * len(self.openings.area) + number, active)
        direction = -self.suns.towards_of(light, numbers[2], numbers[3])
        return self.openings.through(number, (rest, numbers[1]), direction, lambda cosine: numbers[4] * most < cosine, active)


def largest_cosine(rows: int, columns: int, axes: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return the largest cosine to a normal, without sign, in the cells around each entry of a table, (rows, columns).

    A cosine changes by no more than the angle does: that at a cell's middle and the way to its corners are a bound.
    """
    half, step = rows // 2, (np.pi / 2 / (rows // 2 - 1) / 2, np.pi / columns)
    edges = np.concatenate([np.linspace(-np.pi / 2, 0, half), np.linspace(0, np.pi / 2, half)])
    height, turn = (edges[:-1] + edges[1:]) / 2, (np.arange(columns) + 0.5) * 2 * np.pi / columns
    level = (np.cos(turn)[:, None] * axes[0] + np.sin(turn)[:, None] * axes[1]) @ normal
    middle = np.abs(np.cos(height)[:, None] * level + np.sin(height)[:, None] * (axes[2] @ normal))
    widest = np.cos(np.maximum(np.abs(height) - step[0], 0))
    most = np.minimum(middle + np.hypot(step[0], step[1] * widest)[:, None], 1)
    most[half - 1] = 0  # the two rows of the horizon have no cell between them
    most = np.pad(most, ((1, 1), (0, 0)))
    most = np.maximum(most[1:], most[:-1])
    return np.maximum(most, np.roll(most, 1, axis=1))
