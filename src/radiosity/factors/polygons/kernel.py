"""Exact exchange areas of many pairs of patches, on the device.

A kernel looks through all pairs of some rows, and says which face each other and how far apart they are. Pairs that are far
apart, and wholly in front of each other, are integrated by Gauss rules over both areas, in double precision. Of nearer ones, and
of those of which one reaches behind the other's plane, one patch is integrated by a rule and the other by Lambert's formula
(`points`). The order of a rule follows from the distance over the sizes. Pairs that touch or nearly do, or reach behind each
other, go to `exchange`. Errors are below 3e-7, or below 1e-9 of the smaller area where little of a patch is in front.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import Device, upload
from ...device.recorded import loop
from ...device.turn import turn
from ...patches.model import Patches
from .clipping import FLAT, ROUNDING
from .exchange import exchange
from .rules import rule

LANES = 1 << 22  # pairs that are looked through at a time
WORDS = 16  # of a patch: origin, two edges, normal, plane, radius, 1 where it is a triangle, and a word to fill up
# order of the rule: distance of the middles over the sum of the radii, from which its error is below 1e-7
ORDERS = {2: 24.0, 3: 9.0, 4: 4.5, 5: 3.0}
NEAR = 1  # code of pairs that `exchange` takes; the others have the order of their rule
POINTS = {4: 4.5, 6: 2.0, 10: 1.2}  # orders of the rule over one patch alone, and distances as above
AHEAD, BEHIND = 16, 32  # added to these orders: the rule is over the first patch, or over the second


@dataclass(frozen=True, eq=False)
class PairKernel:
    """Finds pairs of patches that face each other, and their exact exchange areas."""

    patches: Patches
    device: Device

    @cached_property
    def corners(self) -> np.ndarray:
        return self.patches.corners

    @cached_property
    def rounding(self) -> float:
        """How accurate coordinates are, metres."""
        return float(ROUNDING * np.abs(self.corners).max(initial=0.0))

    @cached_property
    def records(self):
        """What kernels read of patches, (n * WORDS,) Float64; coordinates are moved to the middle of all."""
        corners = self.corners
        corners = corners - (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / 2
        first, second = corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0]
        triangle = (corners[:, 2] == corners[:, 3]).all(axis=1)
        middle = corners.mean(axis=1)
        normal = np.cross(first, second)
        normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
        words = np.zeros((len(corners), WORDS))
        words[:, :12] = np.concatenate([corners[:, 0], first, second, normal], axis=1)
        words[:, 12] = (normal * middle).sum(axis=1)
        words[:, 13] = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
        words[:, 14] = triangle
        return upload(self.device.types.Float64, words)

    @turn()
    def rows(self, begin: int, end: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the pairs of patches begin <= i < end and j > i that face each other, and A_i F_ij: one, other, values, (m,).

        They come in order of i, then j.
        """
        types, n = self.device.types, len(self.patches)
        UInt32 = types.UInt32
        width = n - 1 - begin
        count = (end - begin) * width
        if count < 1:
            return np.zeros(0, np.uint32), np.zeros(0, np.uint32), np.zeros(0)
        lane = dr.arange(UInt32, max(count, 2))
        row = lane // dr.opaque(UInt32, width)
        one = dr.minimum(row + dr.opaque(UInt32, begin), dr.opaque(UInt32, n - 1))
        other = lane - row * dr.opaque(UInt32, width) + dr.opaque(UInt32, begin + 1)
        code = self._code(one, dr.minimum(other, dr.opaque(UInt32, n - 1)), other > one)
        dr.eval(code)
        code = np.array(code)[:count]
        some = np.flatnonzero(code)
        row, column = np.divmod(some, width)
        one, other = (row + begin).astype(np.uint32), (column + begin + 1).astype(np.uint32)
        values = self._values(one, other, code[some])
        if (values > 0).all():
            return one, other, values
        some = values > 0
        return one[some], other[some], values[some]

    def values(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Return A_i F_ij of pairs, (m,) float64 m², zero where they do not face each other."""
        result = np.zeros(len(one))
        for at in range(0, len(one), LANES):
            i, j = (x[at : at + LANES].astype(np.uint32) for x in (one, other))
            first, second = (upload(self.device.types.UInt32, _twice(x)) for x in (i, j))
            code = np.array(self._code(first, second, True))[: len(i)]
            some = np.flatnonzero(code)
            result[at + some] = self._values(i[some], j[some], code[some])
        return result

    def _values(self, one: np.ndarray, other: np.ndarray, code: np.ndarray) -> np.ndarray:
        result = np.zeros(len(one))
        for order in np.flatnonzero(np.bincount(code)).tolist():
            some = np.flatnonzero(code == order)
            i, j = one[some], other[some]
            if order == NEAR:
                result[some] = exchange(self.corners[i], self.corners[j])
            elif order < AHEAD:
                result[some] = self._by_rule(i, j, order)
            else:
                result[some] = self._from_points(*((i, j) if order < BEHIND else (j, i)), order % AHEAD)
        return result

    def _code(self, one, other, active):
        """Return, for pairs, 0 where they do not face each other, `NEAR`, or the order of the rule."""
        types = self.device.types
        Float64, UInt32 = types.Float64, types.UInt32
        i, j = (self._read(x) for x in (one, other))
        lowest, highest = [], []
        for a, b in ((i, j), (j, i)):
            tips = [_dot(_minus(tip, b.middle), b.normal) for tip in a.tips]
            ways = [_square(_minus(tip, b.middle)) for tip in a.tips]
            longest = dr.sqrt(dr.maximum(dr.maximum(ways[0], ways[1]), dr.maximum(ways[2], ways[3])))
            least = dr.opaque(Float64, self.rounding) + FLAT * longest
            low = dr.minimum(dr.minimum(tips[0], tips[1]), dr.minimum(tips[2], tips[3]))
            high = dr.maximum(dr.maximum(tips[0], tips[1]), dr.maximum(tips[2], tips[3]))
            lowest.append(low < -least)
            highest.append(high > least)
        faces = highest[0] & highest[1] & active
        ratio = dr.sqrt(_square(_minus(i.middle, j.middle))) / (i.radius + j.radius)
        order = UInt32(NEAR)
        for points, least in reversed(ORDERS.items()):
            order = dr.select(ratio > least, UInt32(points), order)
        lone = UInt32(NEAR)
        for points, least in reversed(POINTS.items()):
            lone = dr.select(ratio > least, UInt32(points), lone)
        whole = ~lowest[0] & ~lowest[1]
        over_first = ~lowest[0] & (lowest[1] | (i.radius < j.radius))  # never points of one that is cut
        side = dr.select(over_first, UInt32(AHEAD), UInt32(BEHIND))
        lone = dr.select((lowest[0] & lowest[1]) | (lone == NEAR), UInt32(NEAR), lone + side)
        return dr.select(faces, dr.select(whole & (order != NEAR), order, lone), UInt32(0))

    def _by_rule(self, one: np.ndarray, other: np.ndarray, order: int) -> np.ndarray:
        types, result = self.device.types, np.empty(len(one))
        table = self._table(order)
        for at in range(0, len(one), LANES):
            i, j = (self._read(upload(types.UInt32, _twice(x[at : at + LANES]))) for x in (one, other))
            value = _integral(i, j, order, table, types)
            result[at : at + LANES] = np.array(value)[: len(one) - at]
        return result

    def _from_points(self, one: np.ndarray, other: np.ndarray, order: int) -> np.ndarray:
        """Return A_i F_ij by points of ``one``, of which no part is behind the plane of ``other``."""
        types, result = self.device.types, np.empty(len(one))
        table = self._table(order)
        for at in range(0, len(one), LANES):
            i, j = (self._read(upload(types.UInt32, _twice(x[at : at + LANES]))) for x in (one, other))
            value = from_points(i, j, table, dr.opaque(types.UInt32, order * order), self.rounding, types)
            result[at : at + LANES] = np.array(value)[: len(one) - at]
        return result

    def _table(self, order: int):
        """Return the points of a rule for parallelograms, then for triangles, Float64."""
        return upload(self.device.types.Float64, np.concatenate([rule(order, triangle=flat) for flat in (False, True)]))

    def _read(self, patch) -> "Read":
        Float64 = self.device.types.Float64
        w = [dr.gather(Float64, self.records, patch * WORDS + k) for k in range(15)]
        return Read(w[0:3], w[3:6], w[6:9], w[9:12], w[12], w[13], w[14] > 0.5)


@dataclass(frozen=True, eq=False)
class Read:
    """A patch of each pair, as read by a kernel: vectors are lists of three numbers."""

    origin: list
    first: list
    second: list
    normal: list
    plane: Any
    radius: Any
    triangle: Any

    @cached_property
    def tips(self) -> list[list]:
        """The four corners; a triangle repeats one."""
        second, fourth = _plus(self.origin, self.first), _plus(self.origin, self.second)
        third = [dr.select(self.triangle, y, x + z) for x, y, z in zip(second, fourth, self.second, strict=True)]
        return [self.origin, second, third, fourth]

    @cached_property
    def middle(self) -> list:
        a, b, c, d = self.tips
        return [(w + x + y + z) * 0.25 for w, x, y, z in zip(a, b, c, d, strict=True)]

    def point(self, s, t) -> list:
        return [o + s * a + t * b for o, a, b in zip(self.origin, self.first, self.second, strict=True)]

    def places(self, order: int, types) -> list[tuple]:
        """Return shares along both edges and weights of the points of a rule."""
        quad, flat = rule(order, triangle=False), rule(order, triangle=True)
        Float64 = types.Float64
        return [
            tuple(dr.select(self.triangle, Float64(b), Float64(a)) for a, b in zip(*both, strict=True))
            for both in zip(quad.tolist(), flat.tolist(), strict=True)
        ]

    def place(self, table, index, count, types) -> list:
        """Return shares along both edges and weight of a point of a rule that has ``count``."""
        at = 3 * (index + dr.select(self.triangle, types.UInt32(count), types.UInt32(0)))
        return [dr.gather(types.Float64, table, at + k) for k in range(3)]

    @property
    def area(self):
        x, y = self.first, self.second
        cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]
        return dr.sqrt(_square(cross)) * dr.select(self.triangle, 0.5, 1.0)


def _integral(one: Read, other: Read, order: int, table, types):
    """Return A_i F_ij by rules over both areas: up to weights, the sum of up down / r⁴ over all pairs of points.

    Args:
        table: the rule's points for parallelograms, then for triangles.
    """
    Float64, UInt32 = types.Float64, types.UInt32
    ends = []
    for s, t, weight in other.places(order, types):
        end = other.point(s, t)
        ends.append((end, weight * (_dot(end, one.normal) - one.plane)))

    def body(index, total):
        s, t, weight = one.place(table, index, order * order, types)
        start, sum_here = one.point(s, t), Float64(0)
        for end, up in ends:
            square = _square(_minus(end, start))
            sum_here += up / (square * square)
        return index + 1, total + weight * sum_here * (_dot(start, other.normal) - other.plane)

    width = dr.width(one.plane)
    state = dr.zeros(UInt32, width), dr.zeros(Float64, width)
    _, total = loop(state, lambda index, total: index < order * order, body)
    return total * one.area * other.area / np.pi


def from_points(one: Read, other: Read, table, count, rounding: float, types):
    """Return A_i F_ij by a rule over ``one`` and Lambert's formula for the part of ``other`` in front of its plane.

    See `points.from_points`; that part is the same for all points.

    Args:
        table: the rule's points for parallelograms, then for triangles; ``count`` of each.
    """
    Float64, UInt32 = types.Float64, types.UInt32
    heights = [_dot(tip, one.normal) - one.plane for tip in other.tips]
    heights = [dr.select(dr.abs(h) <= 4 * rounding, 0.0, h) for h in heights]
    edges, sets, rises, closes = [], [Float64(0)] * 3, [Float64(0)] * 3, types.Bool(False)
    for k in range(4):
        tip, following, h, rise = other.tips[k], other.tips[(k + 1) % 4], heights[k], heights[(k + 1) % 4]
        above, next_above = h > 0, rise > 0
        crosses = above ^ next_above
        share = dr.select(crosses, h / dr.select(crosses, h - rise, 1.0), 0.0)
        cut = [x + share * (y - x) for x, y in zip(tip, following, strict=True)]
        start = [dr.select(above, x, y) for x, y in zip(tip, cut, strict=True)]
        end = [dr.select(next_above, x, y) for x, y in zip(following, cut, strict=True)]
        edges.append((start, end, above | next_above))
        sets = [x + dr.select(crosses & above, y, 0.0) for x, y in zip(sets, cut, strict=True)]
        rises = [x + dr.select(crosses & next_above, y, 0.0) for x, y in zip(rises, cut, strict=True)]
        closes |= crosses
    edges.append((sets, rises, closes))

    def body(index, total):
        s, t, weight = one.place(table, index, count, types)
        point = one.point(s, t)
        for start, end, seen in edges:
            a, b = _minus(start, point), _minus(end, point)
            cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
            sine = dr.sqrt(_square(cross))
            seen = seen & (sine > 0)
            angle = dr.atan2(sine, _dot(a, b))
            total = total + dr.select(seen, weight * angle / dr.select(seen, sine, 1.0) * _dot(cross, one.normal), 0.0)
        return index + 1, total

    width = dr.width(one.plane)
    _, total = loop((dr.zeros(UInt32, width), dr.zeros(Float64, width)), lambda index, total: index < count, body)
    return dr.maximum(total / -(2 * np.pi), 0) * one.area


def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _square(a):
    return _dot(a, a)


def _minus(a, b) -> list:
    return [x - y for x, y in zip(a, b, strict=True)]


def _plus(a, b) -> list:
    return [x + y for x, y in zip(a, b, strict=True)]


def _twice(values: np.ndarray) -> np.ndarray:
    """Return the values; of one, two: arrays of one entry would compile kernels of their own."""
    return np.repeat(values, 2) if len(values) == 1 else values
