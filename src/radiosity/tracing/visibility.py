"""Visibility: the share of one polygon that sees another, from lines between points of both.

A pair's share is the sum of the kernel cos cos' / r² over the pairs of points that see each other, divided by the sum over all
of them. So it tends, with more rays, to the true form factor divided by that without obstacles, and it is one where nothing
stands between. The plain mean of visible lines (P. Hanrahan, D. Salzman, L. Aupperle, "A rapid hierarchical radiosity
algorithm", SIGGRAPH 1991) differs from it where the kernel varies over the pair. Polygons are patches, or larger or smaller
elements.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..device.turn import turn
from ..errors import MethodError
from ..patches.model import Patches
from ..sampling.hemisphere import triangle
from ..sampling.numbers import ready
from ..sampling.numbers.random import philox
from .faces import OFFSET
from .geometry import INSET, Geometry
from .hits import first_hit
from .lanes import CHUNK

MOST = (1 << 16) - 1  # rays of a pair
FEW = 8  # rays: sums of fewer are made column by column
WORDS = 10  # of a polygon on the device: origin, two edges, offset


@dataclass(frozen=True, eq=False)
class Polygons:
    """Parallelograms and triangles on faces of a scene.

    Attributes:
        corners: (m, 4, 3) float64, metres, counterclockwise seen from the radiating side; a triangle repeats its last one.
        face: (m,) int, the face that each is a part of.
    """

    corners: np.ndarray
    face: np.ndarray

    @staticmethod
    def of(patches: Patches, numbers: np.ndarray | slice = slice(None)) -> "Polygons":
        """Return patches by their numbers; all of them by default."""
        return Polygons(patches.corners[numbers], patches.face[numbers])

    def __len__(self) -> int:
        return len(self.face)

    def take(self, rows) -> "Polygons":
        """Return some of the polygons (indices, mask or slice)."""
        return Polygons(self.corners[rows], self.face[rows])


def visible_share(geometry: Geometry, one: Polygons, other: Polygons, rays: int = 16, seed: int = 0) -> np.ndarray:
    """Return the share of what goes from ``one`` to ``other`` that meets nothing on its way: (m,) float64 in [0, 1], for m pairs.

    A share is a function of the two polygons, rays and seed alone. It is the same both ways, unless backs let lines pass: then
    it holds from ``one`` to ``other`` only. It is zero where the two do not face each other at any pair of points. Of panes only
    the solid part counts, at both ends (`Patches.solid`); what goes through panes in between is seen.

    Args:
        rays: points of each pair, of the Sobol' sequence in four dimensions with a digital shift for each pair; powers of two
            are best.

    Raises:
        MethodError: fewer than one ray, or more than 65 535.
    """
    whole, part = kernel_means(geometry, one, other, rays, (seed,))[0]
    return np.divide(part, whole, out=np.zeros(len(whole)), where=whole > 0)


@turn()
def kernel_means(
    geometry: Geometry, one: Polygons, other: Polygons, rays: int, seeds: Sequence[int], salts: np.ndarray | None = None
) -> np.ndarray:
    """Return means of cos cos' / r² over points of pairs, 1/m², (seeds, 2, m): of all points, and of those that see each other.

    Args: see `visible_share`; of each seed there are other points.
        salts: (m,) uint64, numbers that give equal pairs other points.

    Raises:
        MethodError: fewer than one ray, or more than 65 535.
    """
    if not 1 <= rays <= MOST:
        raise MethodError(f"rays of a pair are {rays}; they must be 1 to {MOST}")
    first, second = _keys(one.corners), _keys(other.corners)
    if not geometry.some_backs_pass:  # a pair is the same whichever comes first
        swap = first > second
        one, other = (
            Polygons(np.where(swap[:, None, None], b.corners, a.corners), np.where(swap, b.face, a.face))
            for a, b in ((one, other), (other, one))
        )
        first, second = np.where(swap, second, first), np.where(swap, first, second)
    keys = mixed(first * np.uint64(3) + second)
    if salts is not None:
        keys = mixed(keys + salts)
    size = max(CHUNK // rays, 1)
    means = np.empty((len(seeds), 2, len(keys)))
    for rows in (slice(at, at + size) for at in range(0, len(keys), size)):
        chunk = _Chunk.of(geometry, one.take(rows), other.take(rows), keys[rows], rays)
        for into, seed in zip(means, seeds, strict=True):
            into[:, rows] = chunk.means(seed)
    through = geometry.scene.transmittance
    if through is not None and len(keys):  # lines end on the solid part of ``other`` alone
        means[:, 1] *= 1 - through[one.face]
    return means * geometry.bvh.scale**2


@dataclass(frozen=True, eq=False)
class _Chunk:
    """Pairs on the device, in the BVH's units.

    Attributes:
        count: number of pairs.
        records: of both polygons, see `records_of`.
        triangles: 1 where the first polygon is a triangle, and 2 where the second is.
        target: faces that lines should hit.
        words: keys of pairs, low words and high words.
    """

    geometry: Geometry
    rays: int
    count: int
    records: tuple[Any, Any]
    triangles: Any
    target: Any
    words: tuple[Any, Any]

    @staticmethod
    def of(geometry: Geometry, one: Polygons, other: Polygons, keys: np.ndarray, rays: int) -> "_Chunk":
        types, count = geometry.device.types, len(one)
        if count * rays < 2:  # arrays of one entry would compile kernels of their own
            one, other, keys = one.take([0, 0]), other.take([0, 0]), keys[[0, 0]]
        return _Chunk(
            geometry,
            rays,
            count,
            (upload(types.Float, records_of(geometry, one)), upload(types.Float, records_of(geometry, other))),
            upload(types.UInt32, is_triangle(one) | 2 * is_triangle(other)),
            upload(types.UInt32, other.face.astype(np.uint32)),
            (upload(types.UInt32, keys.astype(np.uint32)), upload(types.UInt32, (keys >> np.uint64(32)).astype(np.uint32))),
        )

    def means(self, seed: int) -> np.ndarray:
        """Return both means, (2, count)."""
        geometry, types, rays = self.geometry, self.geometry.device.types, self.rays
        UInt32 = types.UInt32
        lane = dr.arange(UInt32, len(self.target) * rays)
        pair = lane // dr.opaque(UInt32, rays)
        index = lane - pair * dr.opaque(UInt32, rays) + 1
        shift = philox(
            [*(dr.gather(UInt32, word, pair) for word in self.words), UInt32(0), UInt32(0)],
            [dr.opaque(UInt32, seed >> part & 0xFFFFFFFF) for part in (0, 32)],
        )
        numbers = ready("sobol", types).points(index, pair, [*shift, UInt32(0)], 16)
        kinds = dr.gather(UInt32, self.triangles, pair)
        start = point_of(types, self.records[0], pair, (kinds & 1) != 0, *numbers[:2])
        end = point_of(types, self.records[1], pair, (kinds & 2) != 0, *numbers[2:4])
        kernel, met = between(geometry, start, end, dr.gather(UInt32, self.target, pair))
        dr.eval(kernel, met)
        return np.array([_row_sums(np.array(x).reshape(-1, rays)[: self.count]) / rays for x in (kernel, met)])


def between(geometry: Geometry, start, end, target):
    """Return cos cos' / r² of points of pairs, from `point_of`, and the same where the line hits the target face, 0 elsewhere."""
    (begin, normal, above), (there, facing, beyond) = start, end
    way = there - begin
    up, down, square = dr.dot(way, normal), -dr.dot(way, facing), dr.squared_norm(way)
    faces = (up > above) & (down > beyond)  # nearer to a plane than lines begin there is in the plane
    kernel = dr.select(faces, up * down / (square * square), 0)
    origin = begin + normal * above
    hit = first_hit(geometry, origin, dr.normalize(there - origin), active=faces)
    face = dr.gather(geometry.device.types.UInt32, geometry.faces.primitive_faces, hit.primitive, hit.valid)
    return kernel, dr.select(hit.valid & (face == target), kernel, 0)


def _row_sums(values: np.ndarray) -> np.ndarray:
    """Return sums of rows in double precision, (m,)."""
    if values.shape[1] >= FEW:
        return values.astype(np.float64).sum(axis=1)
    total = values[:, 0].astype(np.float64)  # column by column is quicker, and to the same bits
    for column in values.T[1:]:
        total += column
    return total


def point_of(types, records, pair, is_triangle, x, y):
    """Return a point of a polygon, its unit normal, and how far in front of it lines begin."""
    words = [dr.gather(types.Float, records, pair * WORDS + i) for i in range(WORDS)]
    origin, first, second = (types.Array3f(*words[at : at + 3]) for at in (0, 3, 6))
    a, b = triangle(x, y)
    s, t = dr.select(is_triangle, a, x), dr.select(is_triangle, b, y)
    return origin + first * s + second * t, dr.normalize(dr.cross(first, second)), words[9]


def records_of(geometry: Geometry, polygons: Polygons) -> np.ndarray:
    """Return (m, WORDS) float32 in the BVH's coordinates; polygons are drawn in as whole faces are (`Geometry.face_records`)."""
    bvh = geometry.bvh
    points = (polygons.corners - bvh.centre) * bvh.scale
    offset = geometry.faces.offset(polygons.face, points)
    origin, first, second = points[:, 0], points[:, 1] - points[:, 0], points[:, 3] - points[:, 0]
    flat = is_triangle(polygons) == 1
    area = np.maximum(np.linalg.norm(np.cross(first, second), axis=1), 1e-300)
    lengths = [np.linalg.norm(edge, axis=1) for edge in (first, second, second - first)]
    inset = offset * (INSET / OFFSET)
    share = np.minimum(3 * inset * np.max(lengths, axis=0) / area, 0.75)
    margins = [np.where(flat, share / 3, np.minimum(inset * lengths[1 - i] / area, 0.375)) for i in (0, 1)]
    sizes = [np.where(flat, 1 - share, 1 - 2 * margin) for margin in margins]
    drawn = origin + margins[0][:, None] * first + margins[1][:, None] * second
    edges = [edge * size[:, None] for edge, size in zip((first, second), sizes, strict=True)]
    return np.concatenate([drawn, *edges, offset[:, None]], axis=1).astype(np.float32)


def is_triangle(polygons: Polygons) -> np.ndarray:
    """Return 1 for triangles and 0 for parallelograms, (m,) uint32."""
    same = polygons.corners[:, 2] == polygons.corners[:, 3]
    return (same[:, 0] & same[:, 1] & same[:, 2]).astype(np.uint32)


def _keys(corners: np.ndarray) -> np.ndarray:
    """Return a hash of the coordinates, (m,) uint64."""
    bits = np.ascontiguousarray(corners + 0.0).reshape(len(corners), 12).view(np.uint64)
    key = np.zeros(len(bits), np.uint64)
    for column in bits.T:
        key = mixed(key * np.uint64(0x9E3779B97F4A7C15) + column)
    return key


def mixed(x: np.ndarray) -> np.ndarray:
    """Map 64-bit words by a bijection (S. Vigna's SplitMix64)."""
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return x ^ (x >> np.uint64(31))
