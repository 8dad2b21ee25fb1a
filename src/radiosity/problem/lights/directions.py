"""Tables of directions in kernels: their values, and directions drawn in proportion to them.

Tables are linear in azimuth and in z, the sine of the elevation (`scene.lights.sky.Sky`). A solid angle is dz times an azimuth.
So the marginal density of z is linear within a row of cells, and that of azimuth, given z, within a cell. Directions in
proportion to a table come from two numbers by two searches and the roots of two quadratic equations: exactly.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...sampling.hemisphere import turn
from ...scene.lights.sky import row_sines

TINY = 1e-30  # keeps quotients of nothing by nothing finite


@dataclass(eq=False)
class Directions:
    """Tables of one size.

    Attributes:
        values: (n_tables, n_elevations, n_azimuths) float64, of the elevations and azimuths of `Sky`.
        axes: (3, 3) float64, as those of `Sky`.
    """

    values: np.ndarray
    axes: np.ndarray
    _types: Any = field(default=None, init=False)
    _axes: Any = field(default=None, init=False)
    _tables: dict[str, Any] = field(default_factory=dict, init=False)

    @property
    def flux(self) -> np.ndarray:
        """The integral of each table over all directions, (n_tables,)."""
        row = self.values.mean(axis=2)
        return np.pi * (np.diff(row_sines(self.values.shape[1])) * (row[:, 1:] + row[:, :-1])).sum(axis=1)

    def refined(self, rows: int, columns: int) -> np.ndarray:
        """Return the tables at entries between: so many cells in place of one along elevation, and along azimuth."""
        share = np.arange(columns) / columns
        right = np.roll(self.values, -1, axis=2)
        wide = (self.values[..., None] * (1 - share) + right[..., None] * share).reshape(*self.values.shape[:2], -1)
        half, sines = self.values.shape[1] // 2, row_sines(self.values.shape[1])
        finer = row_sines(2 * (rows * (half - 1) + 1))
        upper = finer[len(finer) // 2 :]
        low = np.minimum(np.arange(len(upper)) // rows, half - 2)
        parts = []
        for begin, z in ((0, -upper[::-1]), (half, upper)):
            at = begin + low
            t = ((z - sines[at]) / (sines[at + 1] - sines[at]))[:, None]
            parts.append(wide[:, at] * (1 - t) + wide[:, at + 1] * t)
        return np.concatenate(parts, axis=1)

    def prepare(self, types: Any) -> None:
        """Put the tables on a device."""
        if self._types is types:
            return
        sines, row = row_sines(self.values.shape[1]), self.values.mean(axis=2)
        flux = np.diff(sines) * (row[:, 1:] + row[:, :-1])
        begin = np.cumsum(np.pad(flux, ((0, 0), (1, 0))), axis=1) / np.maximum(flux.sum(axis=1, keepdims=True), TINY)
        cells = (self.values + np.roll(self.values, -1, axis=2)) / 2
        along = np.cumsum(np.pad(cells, ((0, 0), (0, 0), (1, 0))), axis=2)[..., :-1]
        self._types, self._axes = types, [types.Array3f(*axis) for axis in self.axes.tolist()]
        tables = {"value": self.values, "sine": sines, "begin": begin, "row": row, "along": along}
        self._tables = {name: upload(types.Float, table.astype(np.float32)) for name, table in tables.items()}

    # ---- in kernels ------------------------------------------------------------------------------------------------

    def place(self, direction: Any) -> tuple[Any, Any, Any, Any]:
        """Return the row and column of the cell that a unit direction lies in, and the place in it along both."""
        Float, UInt32 = self._types.Float, self._types.UInt32
        _, rows, columns = self.values.shape
        half = rows // 2
        along, aside, up = (dr.dot(axis, direction) for axis in self._axes)
        height = dr.asin(dr.clip(up, -1, 1)) * ((half - 1) / (np.pi / 2))
        from_below = UInt32(dr.clip(height + (half - 1), 0, half - 2))
        row = dr.select(up >= 0, UInt32(dr.clip(height, 0, half - 2)) + half, from_below)
        low, high = self._read("sine", row, True), self._read("sine", row + 1, True)
        turns = dr.atan2(aside, along) * (1 / (2 * np.pi))
        place = dr.select(turns < 0, turns + 1, turns) * columns
        column = dr.minimum(UInt32(place), columns - 1)
        return row, column, dr.clip((up - low) / (high - low), 0, 1), dr.clip(place - Float(column), 0, 1)

    def value(self, table: Any, place: tuple[Any, Any, Any, Any], active: Any = True) -> Any:
        """Return the value of a table, a number or a UInt32, at a place that `place` gave."""
        row, column, t, s = place
        _, rows, columns = self.values.shape
        at, right = (row + table * rows) * columns, self._next(column)
        lower = dr.lerp(self._read("value", at + column, active), self._read("value", at + right, active), s)
        at += columns
        upper = dr.lerp(self._read("value", at + column, active), self._read("value", at + right, active), s)
        return dr.lerp(lower, upper, t)

    def draw(self, table: Any, first: Any, second: Any, active: Any = True) -> tuple[Any, Any]:
        """Return a direction whose density is in proportion to a table, a UInt32, and the value there, from two numbers."""
        Float = self._types.Float
        _, rows, columns = self.values.shape
        start = table * rows

        def marginal(name: str, row: Any) -> Any:
            return self._read(name, start + row, active)

        row = last_at_most(self._types, rows - 1, lambda row: marginal("begin", row), first)
        begin, end = marginal("begin", row), marginal("begin", row + 1)
        low, high = marginal("row", row), marginal("row", row + 1)
        t = _linear((first - begin) / dr.maximum(end - begin, TINY), low, high)
        z = dr.lerp(self._read("sine", row, active), self._read("sine", row + 1, active), t)
        here = (start + row) * columns

        def between(name: str, column: Any) -> Any:
            return dr.lerp(self._read(name, here + column, active), self._read(name, here + columns + column, active), t)

        wanted = second * dr.lerp(low, high, t) * columns
        column = last_at_most(self._types, columns, lambda column: between("along", column), wanted)
        p, q = between("value", column), between("value", self._next(column))
        s = _linear((wanted - between("along", column)) / dr.maximum((p + q) / 2, TINY), p, q)
        cosine, sine = turn((s + Float(column)) * (1 / columns))  # of the azimuth less pi
        across = -dr.sqrt(dr.maximum(1 - z * z, 0))
        direction = self._axes[0] * (cosine * across) + self._axes[1] * (sine * across) + self._axes[2] * z
        return direction, dr.lerp(p, q, s)

    def _read(self, name: str, at: Any, active: Any) -> Any:
        return dr.gather(self._types.Float, self._tables[name], self._types.UInt32(at), active)

    def _next(self, column: Any) -> Any:
        columns = self.values.shape[2]
        return dr.select(column + 1 < columns, column + 1, 0)


def last_at_most(types: Any, count: int, read: Callable[[Any], Any], limit: Any) -> Any:
    """Return the last of ``count`` places whose value is at most a limit, a UInt32; values ascend, and the first is 0."""
    after = dr.binary_search(0, count, lambda place: read(dr.minimum(types.UInt32(place), count - 1)) <= limit)
    return dr.minimum(dr.maximum(types.UInt32(after), 1), count) - 1


def _linear(number: Any, low: Any, high: Any) -> Any:
    """Return a place in [0, 1] whose density goes from ``low`` to ``high`` in proportion, from a number in [0, 1)."""
    root = dr.sqrt(dr.maximum(low * low + number * (high * high - low * low), 0))
    return dr.clip(number * (low + high) / dr.maximum(low + root, TINY), 0, 1)
