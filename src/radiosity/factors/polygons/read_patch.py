"""A patch as a kernel reads it: corners, plane, and points of a rule on it."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr

from .rules import rule
from .vectors import plus, square


@dataclass(frozen=True, eq=False)
class ReadPatch:
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
        second, fourth = plus(self.origin, self.first), plus(self.origin, self.second)
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
        return dr.sqrt(square(cross)) * dr.select(self.triangle, 0.5, 1.0)
