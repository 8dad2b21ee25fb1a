"""Exact exchange areas of many pairs of patches, on the device.

A kernel looks through all pairs of some rows, and says which face each other and how far apart they are. Pairs that are far
apart, and wholly in front of each other, are integrated by Gauss rules over both areas, in double precision. Of nearer ones, and
of those of which one reaches behind the other's plane, one patch is integrated by a rule and the other by Lambert's formula
(`points`). The order of a rule follows from the distance over the sizes. Pairs that touch or nearly do, or reach behind each
other, go to `exchange`. Errors are below 3e-7, or below 1e-9 of the smaller area where little of a patch is in front.
"""

from dataclasses import dataclass
from functools import cached_property

import drjit as dr
import numpy as np

from ...device.backend import Device, upload
from ...device.turn import turn
from ...patches.model import Patches
from .clipping import FLAT, ROUNDING
from .exchange import exchange
from .integrals import by_rules, from_points
from .read_patch import ReadPatch
from .rules import rule
from .vectors import dot, minus, square

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
            tips = [dot(minus(tip, b.middle), b.normal) for tip in a.tips]
            ways = [square(minus(tip, b.middle)) for tip in a.tips]
            longest = dr.sqrt(dr.maximum(dr.maximum(ways[0], ways[1]), dr.maximum(ways[2], ways[3])))
            least = dr.opaque(Float64, self.rounding) + FLAT * longest
            low = dr.minimum(dr.minimum(tips[0], tips[1]), dr.minimum(tips[2], tips[3]))
            high = dr.maximum(dr.maximum(tips[0], tips[1]), dr.maximum(tips[2], tips[3]))
            lowest.append(low < -least)
            highest.append(high > least)
        faces = highest[0] & highest[1] & active
        ratio = dr.sqrt(square(minus(i.middle, j.middle))) / (i.radius + j.radius)
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
            value = by_rules(i, j, order, table, types)
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

    def _read(self, patch) -> ReadPatch:
        Float64 = self.device.types.Float64
        w = [dr.gather(Float64, self.records, patch * WORDS + k) for k in range(15)]
        return ReadPatch(w[0:3], w[3:6], w[6:9], w[9:12], w[12], w[13], w[14] > 0.5)


def _twice(values: np.ndarray) -> np.ndarray:
    """Return the values; of one, two: arrays of one entry would compile kernels of their own."""
    return np.repeat(values, 2) if len(values) == 1 else values
