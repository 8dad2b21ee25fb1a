"""Exchange areas of pairs of patches in a kernel: by rules over both areas, or by points of one and Lambert's formula."""

import drjit as dr
import numpy as np

from ...device.recorded import loop
from .read_patch import ReadPatch
from .vectors import dot, minus, square


def by_rules(one: ReadPatch, other: ReadPatch, order: int, table, types):
    """Return A_i F_ij by rules over both areas: up to weights, the sum of up down / r⁴ over all pairs of points.

    Args:
        table: the rule's points for parallelograms, then for triangles.
    """
    Float64, UInt32 = types.Float64, types.UInt32
    ends = []
    for s, t, weight in other.places(order, types):
        end = other.point(s, t)
        ends.append((end, weight * (dot(end, one.normal) - one.plane)))

    def body(index, total):
        s, t, weight = one.place(table, index, order * order, types)
        start, sum_here = one.point(s, t), Float64(0)
        for end, up in ends:
            apart = square(minus(end, start))
            sum_here += up / (apart * apart)
        return index + 1, total + weight * sum_here * (dot(start, other.normal) - other.plane)

    width = dr.width(one.plane)
    state = dr.zeros(UInt32, width), dr.zeros(Float64, width)
    _, total = loop(state, lambda index, total: index < order * order, body)
    return total * one.area * other.area / np.pi


def from_points(one: ReadPatch, other: ReadPatch, table, count, rounding: float, types):
    """Return A_i F_ij by a rule over ``one`` and Lambert's formula for the part of ``other`` in front of its plane.

    See `points.from_points`; that part is the same for all points.

    Args:
        table: the rule's points for parallelograms, then for triangles; ``count`` of each.
    """
    Float64, UInt32 = types.Float64, types.UInt32
    heights = [dot(tip, one.normal) - one.plane for tip in other.tips]
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
            a, b = minus(start, point), minus(end, point)
            cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
            sine = dr.sqrt(square(cross))
            seen = seen & (sine > 0)
            angle = dr.atan2(sine, dot(a, b))
            total = total + dr.select(seen, weight * angle / dr.select(seen, sine, 1.0) * dot(cross, one.normal), 0.0)
        return index + 1, total

    width = dr.width(one.plane)
    _, total = loop((dr.zeros(UInt32, width), dr.zeros(Float64, width)), lambda index, total: index < count, body)
    return dr.maximum(total / -(2 * np.pi), 0) * one.area
