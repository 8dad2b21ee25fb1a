"""Antiderivatives of an image, for integrals along the edges of footprints.

By Green's theorem the integral of f over a footprint is that of p dy - q dx around it, plus the mean of f times its area, where
f = mean + dp/dx + dq/dy. Here p(x, y) is the integral along a row of f minus the row's mean, and q(y) the integral of the rows'
means minus the mean of all. So both repeat where the image does, and stay small. Along an axis that is clamped no mean is
taken off, and p or q is linear outside the image.

Coordinates are those of texels, x to the right and y down, from the corner of the image's first texel. In a table's own
coordinates every cell between whole numbers holds one polynomial: the cells are texels, or the squares between their centres.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .sampler import Sampler, fold, periods


@dataclass(frozen=True)
class Axis:
    """The columns, or the rows, of a table.

    Attributes:
        texels: (n,) int, the image's texel in each. The last is the first again where the axis repeats; the first and the last
            stand for all that lies outside where it is clamped.
        period: whole numbers after which the axis repeats, or 0.
        scale, shift: own coordinate = scale times the texel coordinate + shift.
    """

    texels: np.ndarray
    period: int
    scale: float
    shift: float

    @staticmethod
    def of(count: int, wrap: str, *, linear: bool, scale: float) -> "Axis":
        """The axis of ``count`` texels of an image."""
        period = periods(count, wrap)
        ends = (0, period + 1) if period else (-1, count + 1)
        return Axis(fold(np.arange(*ends), count, wrap), period, scale, -ends[0] - 0.5 * linear)

    def own(self, at: np.ndarray) -> np.ndarray:
        """Own coordinates from texel coordinates."""
        return at * self.scale + self.shift

    def cell(self, middle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The table's cell, int64, and where it begins, float64, of cells that hold these own coordinates."""
        begin = np.floor(middle)
        if self.period:
            return (begin % self.period).astype(np.int64), begin
        begin = np.clip(begin, 0, len(self.texels) - 2)
        return begin.astype(np.int64), begin

    def lines(self, one: np.ndarray, two: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The first whole number strictly between own coordinates, and how many there are, float64 each."""
        low, high = np.minimum(one, two), np.maximum(one, two)
        if not self.period:
            low, high = (np.clip(end, 0, len(self.texels) - 1) for end in (low, high))
        elif self.period == 1:
            return low, np.zeros(len(low))  # all the same along the axis
        first = np.floor(low) + 1
        return first, np.maximum(np.ceil(high) - first, 0)


class Tables:
    """The antiderivatives of some bands of an image at one scale.

    Args:
        image: (height, width, n) float.
        sampler: its wraps and filter.
        scale: (2,) the image's texels in one of the coordinates' texels, along x and y.
    """

    def __init__(self, image: np.ndarray, sampler: Sampler, scale: tuple[float, float] = (1.0, 1.0)):
        self.linear = sampler.filter == "linear"
        axes = zip((image.shape[1], image.shape[0]), sampler.wrap, scale, strict=True)
        self.x, self.y = (Axis.of(count, wrap, linear=self.linear, scale=by) for count, wrap, by in axes)
        whole = np.moveaxis(image, 2, 0)[:, self.y.texels[:, None], self.x.texels].astype(np.float64)
        bands, height, width = whole.shape
        rows = whole[:, :, : width - 1].mean(axis=2) if self.x.period else np.zeros((bands, height))
        self.mean = rows[:, : height - 1].mean(axis=1) if self.y.period else np.zeros(bands)
        whole -= rows[:, :, None]
        self.width = width
        self.values = whole.reshape(bands, -1)
        self.along = self._from_corner(whole, self._sums(whole, 2), self.x).reshape(bands, -1)
        self.row_values = rows - self.mean[:, None]
        self.row_sums = self._from_corner(self.row_values, self._sums(self.row_values, 1), self.y)

    def _from_corner(self, values: np.ndarray, sums: np.ndarray, axis: Axis) -> np.ndarray:
        """Antiderivatives along the last axis that are 0 at the corner of the first texel, at every scale and filter."""
        corner = axis.own(np.zeros(1))
        cell, begin = axis.cell(corner)
        at = np.arange(cell[0], values.size, values.shape[-1])
        start = self._row(values.ravel(), sums.ravel(), at)(corner - begin)
        return sums - start.reshape(*values.shape[:-1], 1)

    def _sums(self, values: np.ndarray, axis: int) -> np.ndarray:
        """The antiderivative at whole numbers, 0 at the first."""
        values = np.moveaxis(values, axis, -1)
        steps = (values[..., 1:] + values[..., :-1]) / 2 if self.linear else values[..., :-1]
        sums = np.concatenate([np.zeros((*values.shape[:-1], 1)), np.cumsum(steps, axis=-1)], axis=-1)
        return np.moveaxis(sums, -1, axis)

    @cached_property
    def _down(self) -> tuple[np.ndarray, np.ndarray]:
        """`values` and `along`, summed over rows."""
        shape = (len(self.values), -1, self.width)
        return tuple(self._sums(table.reshape(shape), 1).reshape(len(table), -1) for table in (self.values, self.along))  # type: ignore[return-value]

    def p(self, band: int, at: np.ndarray) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
        """p at offsets (x, y) in cells, ``at`` their numbers in the table."""
        upper = self._row(self.values[band], self.along[band], at)
        if not self.linear:
            return lambda x, y: upper(x)
        lower = self._row(self.values[band], self.along[band], at + self.width)
        return lambda x, y: (1 - y) * upper(x) + y * lower(x)

    def q(self, band: int, row: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """q at offsets y in cells of a row."""
        return self._row(self.row_values[band], self.row_sums[band], row)

    def down(self, band: int, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """The integral of p over y, from 0 to y at x, both own coordinates."""
        (column, left), (row, top) = self.x.cell(x), self.y.cell(y)
        at, x, y = row * self.width + column, x - left, y - top
        values, along = self.values[band], self.along[band]
        values_down, along_down = (table[band] for table in self._down)
        upper = self._row(values, along, at)(x)
        result = self._row(values_down, along_down, at)(x) + y * upper
        if self.linear:
            result += y * y / 2 * (self._row(values, along, at + self.width)(x) - upper)
        if self.y.period:
            whole = self._row(values_down, along_down, self.y.period * self.width + column)(x)
            result += (top - row) / self.y.period * whole
        return result

    def _row(self, values: np.ndarray, sums: np.ndarray, at: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """An antiderivative at offsets x in cells ``at``."""
        begin, value = sums.take(at), values.take(at)
        if not self.linear:
            return lambda x: begin + x * value
        slope = (values.take(at + 1) - value) / 2
        return lambda x: begin + x * (value + x * slope)


def coarser(image: np.ndarray, sampler: Sampler, factor: int) -> tuple[np.ndarray, tuple[float, float]]:
    """An image of fewer, larger texels with the same means, and its scale. An axis that is clamped stays as it is."""
    scale = []
    for axis, wrap in ((1, sampler.wrap[0]), (0, sampler.wrap[1])):
        count = image.shape[axis]
        new = count if wrap == "clamp" else max(1, -(-count // factor))
        scale.append(new / count)
        if new < count:
            image = _averaged(image, axis, new)
    return image, (scale[0], scale[1])


def _averaged(image: np.ndarray, axis: int, new: int) -> np.ndarray:
    """Means of ``new`` equal parts of an axis."""
    values = np.moveaxis(image, axis, 0).astype(np.float64)
    sums = np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)])
    ends = np.arange(new + 1) * (len(values) / new)
    whole = np.minimum(ends.astype(np.int64), len(values) - 1)
    part = (ends - whole).reshape(-1, *[1] * (values.ndim - 1))
    at_ends = sums[whole] + part * values[whole]
    return np.moveaxis(np.diff(at_ends, axis=0) * (new / len(values)), 0, axis)
