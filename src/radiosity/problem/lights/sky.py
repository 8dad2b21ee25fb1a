"""The sky: the radiance of lines that leave the scene, and rows that fire lines from it.

Both read one table, linear in azimuth and in z, the sine of the elevation (`scene.lights.sky.Sky`). Since a solid angle is
dz times an azimuth, the marginal density of z is linear within a row of cells, and that of azimuth, given z, within a cell. So
directions in proportion to radiance come from two numbers by two searches and the roots of two quadratic equations: exactly for
the radiance that lines see.

Bands in proportion share a row. Other bands have rows of their own, whose power in all others is zero: no line then carries a
weight that depends on its direction.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...sampling.hemisphere import turn
from ...scene.lights.sky import Sky
from .ball import Ball
from .base import AbstractSky

TINY = 1e-30  # keeps quotients of nothing by nothing finite
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
    _geometry: Any = field(default=None, init=False)
    _axes: Any = field(default=None, init=False)
    _tables: dict[str, Any] = field(default_factory=dict, init=False)

    @cached_property
    def leaders(self) -> list[int]:
        """The band of the table that each row's directions follow."""
        return list(dict.fromkeys(leader for leader, _ in self._shapes if leader is not None))

    @cached_property
    def _shapes(self) -> list[tuple[int | None, float]]:
        """The first band that each band of the table is in proportion to, and the ratio; None: it is black."""
        found: list[tuple[int | None, float]] = []
        table = self.sky.radiance
        for band in range(table.shape[2]):
            flux = self.sky.flux[band]
            for leader in dict.fromkeys(one for one, _ in found if one is not None):
                ratio = flux / self.sky.flux[leader]
                if flux > 0 and np.allclose(table[..., band], ratio * table[..., leader], rtol=SAME, atol=0):
                    found.append((leader, ratio))
                    break
            else:
                found.append((band, 1.0) if flux > 0 else (None, 0.0))
        return found

    @cached_property
    def power(self) -> np.ndarray:
        result = np.zeros((len(self.leaders), len(self._shapes)))
        for band, (leader, ratio) in enumerate(self._shapes):
            if leader is not None:
                result[self.leaders.index(leader), band] = self.sky.flux[leader] * self.ball.disc * ratio
        return np.broadcast_to(result, (len(result), self.n_bands)).copy()

    def prepare(self, geometry: Any) -> None:
        if self._geometry is geometry:
            return
        types, table, sines = geometry.device.types, self.sky.radiance, self.sky.sines
        chosen = table[..., self.leaders]
        row = chosen.mean(axis=1)
        flux = np.diff(sines)[:, None] * (row[1:] + row[:-1])
        begin = np.concatenate([np.zeros((1, len(self.leaders))), np.cumsum(flux, axis=0)]) / flux.sum(axis=0)
        cells = (chosen + np.roll(chosen, -1, axis=1)) / 2
        along = np.concatenate([np.zeros_like(row)[:, None], np.cumsum(cells, axis=1)[:, :-1]], axis=1)
        self._geometry, self._axes = geometry, [types.Array3f(*axis) for axis in self.sky.axes.tolist()]
        tables = {
            "radiance": np.moveaxis(table, 2, 0),
            "sine": sines,
            "begin": begin.T,
            "row": row.T,
            "cell": np.moveaxis(chosen, 2, 0),
            "along": np.moveaxis(along, 2, 0),
        }
        self._tables = {name: upload(types.Float, values.astype(np.float32)) for name, values in tables.items()}

    # ---- what lines see ----------------------------------------------------------------------------------------------

    def radiance(self, direction: Any) -> list[Any]:
        """Return the radiance that lines see in a direction once they have left the scene, one Float a band; in a kernel.

        Args:
            direction: three floats, of unit length.
        """
        types = self._geometry.device.types
        Float, UInt32 = types.Float, types.UInt32
        rows, columns, n_bands = self.sky.radiance.shape
        half = rows // 2
        along, aside, up = (dr.dot(axis, direction) for axis in self._axes)
        height = dr.asin(dr.clip(up, -1, 1)) * ((half - 1) / (np.pi / 2))
        from_below = UInt32(dr.clip(height + (half - 1), 0, half - 2))
        low = dr.select(up >= 0, UInt32(dr.clip(height, 0, half - 2)) + half, from_below)
        one, other = self._read("sine", low), self._read("sine", low + 1)
        t = dr.clip((up - one) / (other - one), 0, 1)
        turns = dr.atan2(aside, along) * (1 / (2 * np.pi))
        place = dr.select(turns < 0, turns + 1, turns) * columns
        left = dr.minimum(UInt32(place), columns - 1)
        s, right = dr.clip(place - Float(left), 0, 1), self._next(left)
        result = []
        for band in range(n_bands):
            at = low * columns + band * rows * columns
            lower = dr.lerp(self._read("radiance", at + left), self._read("radiance", at + right), s)
            upper = dr.lerp(self._read("radiance", at + columns + left), self._read("radiance", at + columns + right), s)
            result.append(dr.lerp(lower, upper, t))
        return result * (self.n_bands if n_bands == 1 else 1)

    # ---- lines -------------------------------------------------------------------------------------------------------

    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        direction = -self.towards(light, numbers[0], numbers[1])
        return self.ball.enter(self._geometry, direction, numbers[2], numbers[3]), direction

    def towards(self, light: Any, first: Any, second: Any) -> Any:
        """Return directions to the sky with a density in proportion to the radiance of a row's band; called in a kernel."""
        UInt32 = self._geometry.device.types.UInt32
        rows, columns = self.sky.radiance.shape[:2]
        start = light * rows
        low = self._last(rows - 1, lambda row: self._read("begin", start + row), first)
        begin, end = self._read("begin", start + low), self._read("begin", start + low + 1)
        t = _linear(
            (first - begin) / dr.maximum(end - begin, TINY),
            self._read("row", start + low),
            self._read("row", start + low + 1),
        )
        z = dr.lerp(self._read("sine", low), self._read("sine", low + 1), t)
        here = (start + low) * columns

        def between(name: str, column: Any) -> Any:
            return dr.lerp(self._read(name, here + column), self._read(name, here + columns + column), t)

        whole = dr.lerp(self._read("row", start + low), self._read("row", start + low + 1), t) * columns
        wanted = second * whole
        left = self._last(columns, lambda column: between("along", column), wanted)
        p, q = between("cell", left), between("cell", self._next(left))
        s = _linear((wanted - between("along", left)) / dr.maximum((p + q) / 2, TINY), p, q)
        cosine, sine = turn((s + self._geometry.device.types.Float(UInt32(left))) * (1 / columns))  # of the angle less pi
        across = -dr.sqrt(dr.maximum(1 - z * z, 0))
        return self._axes[0] * (cosine * across) + self._axes[1] * (sine * across) + self._axes[2] * z

    def _read(self, name: str, at: Any) -> Any:
        types = self._geometry.device.types
        return dr.gather(types.Float, self._tables[name], types.UInt32(at))

    def _next(self, column: Any) -> Any:
        columns = self.sky.radiance.shape[1]
        return dr.select(column + 1 < columns, column + 1, 0)

    def _last(self, count: int, read: Any, limit: Any) -> Any:
        """Return the last of ``count`` places whose value is at most a limit; values ascend, and the first is 0."""
        UInt32 = self._geometry.device.types.UInt32
        after = dr.binary_search(0, count, lambda place: read(dr.minimum(UInt32(place), count - 1)) <= limit)
        return dr.minimum(dr.maximum(UInt32(after), 1), count) - 1


def _linear(number: Any, low: Any, high: Any) -> Any:
    """Return a place in [0, 1] whose density goes from ``low`` to ``high`` in proportion, from a number in [0, 1)."""
    root = dr.sqrt(dr.maximum(low * low + number * (high * high - low * low), 0))
    return dr.clip(number * (low + high) / dr.maximum(low + root, TINY), 0, 1)
