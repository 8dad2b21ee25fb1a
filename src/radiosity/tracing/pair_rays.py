"""Rays between pairs of patches: sums over points of both of what would arrive, and of what does arrive.

A ray leads from a uniform point of one patch to one of the other. Its weight is cos cos' / r², times a number of the pair that
makes the mean weight of all rays one. So the mean weight of rays that arrive is the visible share of the pair.

The points of a batch are k times four irrational numbers, from a random place that follows from both patches, the seed and the
batch (H. Niederreiter, "Random number generation and quasi-Monte Carlo methods", 1992, chapter 3). So they are a function of the
pair, whatever is traced beside it, and different batches are independent.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import small, upload
from ..device.recorded import loop
from ..device.turn import turn
from ..sampling.hemisphere import triangle
from ..sampling.numbers.random import philox
from .geometry import Geometry
from .hits import first_hit
from .visibility import Polygons, is_triangle, records_of

LANES = 1 << 22  # pairs of a launch
WORDS = 15  # of a patch: origin, edges, normal, least offset, 1 where it is a triangle, area
# powers of 1 / g, where g^5 = g + 1, as 32-bit fractions: the four numbers
STEPS = tuple(round((1.1673039782614187**-k % 1) * 2**32) for k in range(1, 5))


@dataclass(frozen=True)
class Sums:
    """Sums over the rays of each pair, (m,) float32 each.

    Attributes:
        weights, arriving: of the weights of all rays, and of those that arrive.
        squares, arriving_squares: of their squares.
    """

    weights: np.ndarray
    arriving: np.ndarray
    squares: np.ndarray
    arriving_squares: np.ndarray

    def take(self, rows) -> "Sums":
        """Return those of some pairs."""
        return Sums(*(getattr(self, name)[rows] for name in NAMES))


NAMES = ("weights", "arriving", "squares", "arriving_squares")


@dataclass(frozen=True, eq=False)
class PairRays:
    """Casts rays between patches of a scene."""

    geometry: Geometry

    @cached_property
    def records(self):
        """What kernels read of patches, (n * WORDS,) Float, in the BVH's coordinates."""
        polygons = Polygons.of(self.geometry.patches)
        words = records_of(self.geometry, polygons)  # origin, edges, offset
        normal = np.cross(words[:, 3:6].astype(np.float64), words[:, 6:9])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        area = self.geometry.patches.area * self.geometry.bvh.scale  # m² times the scale: of two patches, times its square
        record = np.concatenate([words[:, :9], normal, words[:, 9:], is_triangle(polygons)[:, None], area[:, None]], axis=1)
        return upload(self.geometry.device.types.Float, record.astype(np.float32))

    @cached_property
    def faces(self):
        """The face of each patch, (n,) UInt32."""
        return upload(self.geometry.device.types.UInt32, self.geometry.patches.face.astype(np.uint32))

    @turn()
    def cast(self, one: np.ndarray, other: np.ndarray, values: np.ndarray, rays: int, batch: int, seed: int) -> Sums:
        """Return sums over rays.

        Args:
            one, other: (m,) numbers of patches.
            values: (m,) m², A_i F_ij without obstacles, above zero.
            rays: of each pair, 1 or more.
            batch: a number that chooses other points.
        """
        types, count = self.geometry.device.types, len(one)
        UInt32 = types.UInt32
        self.geometry.prepare_hits()
        found = np.empty((len(NAMES), count), np.float32)
        key = small(UInt32, [seed & 0xFFFFFFFF, seed >> 32 & 0xFFFFFFFF, batch])
        for at in range(0, count, LANES):
            rows = slice(at, min(at + LANES, count))
            some = rows if rows.stop - at > 1 else [at, at]  # arrays of one entry would compile kernels of their own
            first, second = (upload(UInt32, x[some].astype(np.uint32)) for x in (one, other))
            sums = self._sums(first, second, upload(types.Float, values[some].astype(np.float32)), dr.opaque(UInt32, rays), key)
            dr.eval(sums)
            found[:, rows] = [np.array(x)[: rows.stop - at] for x in sums]
        weights, arriving, squares, arriving_squares = found
        return Sums(weights, arriving, squares, arriving_squares)

    def _sums(self, one, other, values, rays, key):
        geometry, types = self.geometry, self.geometry.device.types
        Float, UInt32 = types.Float, types.UInt32
        k0, k1, batch = (dr.gather(UInt32, key, UInt32(i)) for i in range(3))
        words = philox([one, other, batch, UInt32(0)], [k0, k1])
        first, second, target = self._read(one), self._read(other), dr.gather(UInt32, self.faces, other)
        unit = first.area * second.area / (values * math.pi)

        def body(index, *sums):
            numbers = [Float((w + index * UInt32(step)) >> 8) * 2.0**-24 for w, step in zip(words, STEPS, strict=True)]
            start, normal, above = first.point(*numbers[:2])
            end, facing, beyond = second.point(*numbers[2:])
            way = end - start
            up, down, square = dr.dot(way, normal), -dr.dot(way, facing), dr.squared_norm(way)
            faces = (up > above) & (down > beyond)  # nearer to a plane than lines begin there is in the plane
            weight = dr.select(faces, unit * (up * down / (square * square)), 0)
            origin = start + normal * above
            hit = first_hit(geometry, origin, dr.normalize(end - origin), active=faces)
            seen = hit.valid & (dr.gather(UInt32, geometry.faces.primitive_faces, hit.primitive, hit.valid) == target)
            met = dr.select(seen, weight, 0)
            return index + 1, *(s + x for s, x in zip(sums, (weight, met, weight * weight, met * met), strict=True))

        width = dr.width(one)
        state = (dr.zeros(UInt32, width), *(dr.zeros(Float, width) for _ in range(4)))
        return loop(state, lambda index, *sums: index < rays, body)[1:]

    def _read(self, patch) -> "Patch":
        types = self.geometry.device.types
        words = [dr.gather(types.Float, self.records, patch * WORDS + i) for i in range(WORDS)]
        origin, first, second, normal = (types.Array3f(*words[at : at + 3]) for at in (0, 3, 6, 9))
        return Patch(origin, first, second, normal, words[12], words[13] > 0.5, words[14])


@dataclass(frozen=True)
class Patch:
    """A patch of each pair, as read by the kernel."""

    origin: Any
    first: Any
    second: Any
    normal: Any
    offset: Any
    is_triangle: Any
    area: Any

    def point(self, x, y):
        """Return a point, the normal, and how far in front of it lines begin."""
        a, b = triangle(x, y)
        s, t = dr.select(self.is_triangle, a, x), dr.select(self.is_triangle, b, y)
        return self.origin + self.first * s + self.second * t, self.normal, self.offset
