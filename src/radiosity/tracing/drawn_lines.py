"""Lines between polygons that are drawn from tables, other ones for each line: what clusters see of each other.

It is `visibility` where a pair has many polygons at each end. A table is uploaded once, and a line has the number of a polygon at
each of its ends.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..device.turn import turn
from ..sampling.hemisphere import hemisphere
from ..sampling.numbers import ready
from ..sampling.numbers.random import philox
from .geometry import Geometry
from .hits import first_hit, patch_of
from .visibility import WORDS, Polygons, between, is_triangle, point_of, records_of


@dataclass(frozen=True, eq=False)
class Table:
    """Polygons on the device.

    Attributes:
        records: see `visibility.records_of`.
        faces: the face of each, twice, and one more where it is a triangle.
        count: their number.
    """

    records: Any
    faces: Any
    count: int

    @staticmethod
    def of(geometry: Geometry, polygons: Polygons) -> "Table":
        types = geometry.device.types
        faces = 2 * polygons.face.astype(np.uint32) + is_triangle(polygons)
        return Table(upload(types.Float, records_of(geometry, polygons)), upload(types.UInt32, faces), len(polygons))

    def joined(self, other: "Table") -> "Table":
        """Return a table of both, the other's polygons after these."""
        if not other.count:
            return self
        records, faces = dr.concat([self.records, other.records]), dr.concat([self.faces, other.faces])
        dr.eval(records, faces)
        return Table(records, faces, self.count + other.count)


@turn()
def kernels(
    geometry: Geometry, table: Table, source: np.ndarray, receiver: np.ndarray, keys: np.ndarray, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return cos cos' / r² of lines, and the same where they meet nothing on their way, 0 elsewhere, (m, rays) float64 1/m² each.

    The points of a pair are those of the Sobol' sequence, with a digital shift for each pair.

    Args:
        source, receiver: (m, rays), polygons of the table, from which lines lead and to which.
        keys: (m,) uint64, the numbers of pairs.
    """
    types, (m, rays) = geometry.device.types, source.shape
    if m * rays < 2:  # arrays of one entry would compile kernels of their own
        source, receiver, keys = (np.repeat(values, 2, axis=0) for values in (source, receiver, keys))
        found = kernels(geometry, table, source, receiver, keys, seed)
        return found[0][:m], found[1][:m]
    numbers, UInt32 = _numbers(types, keys, rays, seed), types.UInt32
    rows = [upload(UInt32, ends.astype(np.uint32)) for ends in (source, receiver)]
    faces = [dr.gather(UInt32, table.faces, row) for row in rows]
    start, end = (
        point_of(types, table.records, row, (face & 1) != 0, *numbers[at : at + 2])
        for row, face, at in zip(rows, faces, (0, 2), strict=True)
    )
    found = between(geometry, start, end, faces[1] >> 1)
    dr.eval(found)
    kernel, met = (np.array(values, np.float64).reshape(m, rays) * geometry.bvh.scale**2 for values in found)
    return kernel, met


@turn()
def cosine_lines(
    geometry: Geometry, table: Table, receiver: np.ndarray, keys: np.ndarray, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the patches that local lines of polygons hit, (m, rays) int64, and cos cos' / r² of where they leave and hit, 1/m².

    The number of patches stands for lines that hit none.

    Args:
        receiver: (m, rays), polygons of the table, which lines leave.
        keys: (m,) uint64, numbers that give rows other points.
    """
    types, (m, rays) = geometry.device.types, receiver.shape
    if m * rays < 2:  # arrays of one entry would compile kernels of their own
        found = cosine_lines(geometry, table, np.repeat(receiver, 2, axis=0), np.repeat(keys, 2), seed)
        return found[0][:m], found[1][:m]
    UInt32, none = types.UInt32, len(geometry.patches)
    numbers = _numbers(types, keys, rays, seed)
    row = upload(UInt32, receiver.astype(np.uint32))
    begin, normal, above = point_of(types, table.records, row, (dr.gather(UInt32, table.faces, row) & 1) != 0, *numbers[:2])
    first = dr.normalize(types.Array3f(*(dr.gather(types.Float, table.records, row * WORDS + i) for i in (3, 4, 5))))
    x, y, z = hemisphere(*numbers[2:4])
    way = first * x + dr.cross(normal, first) * y + normal * z
    hit = first_hit(geometry, begin + normal * above, way)
    patch = patch_of(geometry, hit, none, none)
    face = dr.gather(UInt32, geometry.faces.primitive_faces, hit.primitive, hit.valid)
    facing = dr.abs(dr.dot(way, dr.gather(types.Array3f, _normals(geometry), face, hit.valid)))
    kernel = dr.select(hit.valid, z * facing / dr.square(hit.distance), 0)
    dr.eval(patch, kernel)
    hits, values = np.array(patch, np.int64), np.array(kernel, np.float64) * geometry.bvh.scale**2
    return hits.reshape(m, rays), values.reshape(m, rays)


def _numbers(types, keys: np.ndarray, rays: int, seed: int):
    """Return the points of lines, whose randomisation each row of lines has for itself."""
    UInt32 = types.UInt32
    words = [upload(UInt32, (keys >> np.uint64(part)).astype(np.uint32)) for part in (0, 32)]
    lane = dr.arange(UInt32, len(keys) * rays)
    pair = lane // dr.opaque(UInt32, rays)
    shift = philox(
        [*(dr.gather(UInt32, word, pair) for word in words), UInt32(0), UInt32(0)],
        [dr.opaque(UInt32, seed >> part & 0xFFFFFFFF) for part in (0, 32)],
    )
    index = lane - pair * dr.opaque(UInt32, rays) + 1
    return ready("sobol", types).points(index, pair, [*shift, UInt32(0)], 16)


def _normals(geometry: Geometry):
    """Return the normals of faces, which are uploaded once."""
    if "normals" not in geometry.made:
        geometry.made["normals"] = upload(geometry.device.types.Float, geometry.scene.normal)
    return geometry.made["normals"]
