"""Openings, such as windows: more lines of the sky and of suns go through them."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...device.recorded import loop
from ...sampling.hemisphere import triangle

NONE = 0xFFFFFFFF  # in place of an opening's number
WORDS = 12  # of an opening: origin, two edges that are dual to those of the polygon, and the normal


@dataclass(frozen=True, eq=False)
class Openings:
    """Parallelograms and triangles that stop no line.

    Attributes:
        geometry: the scene on a device, a `tracing.geometry.Geometry`.
        corners: (n, 4, 3) float64, m, around each; a triangle repeats its last corner.
    """

    geometry: Any
    corners: np.ndarray

    def __len__(self) -> int:
        return len(self.corners)

    @cached_property
    def placed(self) -> np.ndarray:
        """Corners in the BVH's coordinates, (n, 4, 3) float64, as faces have theirs: row by row, not around."""
        bvh = self.geometry.bvh
        return ((self.corners - bvh.centre) * bvh.scale)[:, [0, 1, 3, 2]]

    @cached_property
    def is_triangle(self) -> np.ndarray:
        return (self.corners[:, 2] == self.corners[:, 3]).all(axis=1)

    @cached_property
    def edges(self) -> tuple[np.ndarray, np.ndarray]:
        """Two edges of each from its first corner, (n, 3) each, in the BVH's coordinates."""
        return self.placed[:, 1] - self.placed[:, 0], self.placed[:, 2] - self.placed[:, 0]

    @cached_property
    def normal(self) -> np.ndarray:
        cross = np.cross(*self.edges)
        return cross / np.linalg.norm(cross, axis=1, keepdims=True)

    @cached_property
    def area(self) -> np.ndarray:
        """The area of each in the BVH's units, (n,)."""
        return np.linalg.norm(np.cross(*self.edges), axis=1) * np.where(self.is_triangle, 0.5, 1.0)

    # ---- on the device ---------------------------------------------------------------------------------------------

    def prepare(self) -> None:
        """Make what kernels read."""
        _ = self.records, self.points, self.triangles, self.count

    @property
    def types(self):
        return self.geometry.device.types

    @cached_property
    def records(self):
        """Records, (n * WORDS,) Float: a point p lies at (s, t) = ((p - origin) . dual_1, (p - origin) . dual_2)."""
        first, second = self.edges
        cross = np.cross(first, second)
        square = (cross**2).sum(axis=1, keepdims=True)
        duals = np.cross(second, cross) / square, np.cross(cross, first) / square
        return upload(self.types.Float, np.concatenate([self.placed[:, 0], *duals, self.normal], axis=1).astype(np.float32))

    @cached_property
    def points(self):
        """Origins and edges, (n * 9,) Float."""
        return upload(self.types.Float, np.concatenate([self.placed[:, 0], *self.edges], axis=1).astype(np.float32))

    @cached_property
    def triangles(self):
        """Flags of triangles, (n + 1,) UInt32; the last one stands for none."""
        return upload(self.types.UInt32, np.append(self.is_triangle, False).astype(np.uint32))

    @cached_property
    def count(self):
        return dr.opaque(self.types.UInt32, len(self))

    def nearest(self, origin, direction, active):
        """Return the first opening that lines cross, `NONE` where there is none, the distance, and the side: whether they come
        to the side of its normal. Called in a kernel."""
        types = self.types
        UInt32, Float, Array3f = types.UInt32, types.Float, types.Array3f

        def body(number, found, distance, front):
            words = [dr.gather(Float, self.records, number * WORDS + i, active) for i in range(WORDS)]
            start, one, two, normal = (Array3f(*words[at : at + 3]) for at in range(0, WORDS, 3))
            across = dr.dot(direction, normal)
            along = dr.dot(start - origin, normal) / dr.select(across == 0, 1, across)
            point = origin + direction * along - start
            s, t = dr.dot(point, one), dr.dot(point, two)
            flat = dr.gather(UInt32, self.triangles, number, active) != 0
            inside = (s >= 0) & (t >= 0) & dr.select(flat, s + t <= 1, (s <= 1) & (t <= 1))
            crossed = active & inside & (across != 0) & (along > 0) & (along < distance)
            return (
                number + 1,
                dr.select(crossed, number, found),
                dr.select(crossed, along, distance),
                dr.select(crossed, across < 0, front),
            )

        width = dr.width(origin, direction)
        state = (
            dr.zeros(UInt32, width),
            dr.full(UInt32, NONE, width),
            dr.full(Float, np.inf, width),
            dr.full(types.Bool, False, width),
        )
        count = self.count
        _, found, distance, front = loop(state, lambda number, *_: number < count, body)
        return found, distance, front

    def point(self, number, u, v, active):
        """Return a uniform point of an opening, and its unit normal; called in a kernel."""
        types = self.types
        words = [dr.gather(types.Float, self.points, number * 9 + i, active) for i in range(9)]
        origin, first, second = (types.Array3f(*words[at : at + 3]) for at in (0, 3, 6))
        a, b = triangle(u, v)
        flat = dr.gather(types.UInt32, self.triangles, number, active) != 0
        s, t = dr.select(flat, a, u), dr.select(flat, b, v)
        normal = types.Array3f(*(dr.gather(types.Float, self.records, number * WORDS + 9 + i, active) for i in range(3)))
        return origin + first * s + second * t, normal
