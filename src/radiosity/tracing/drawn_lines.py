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
from ..sampling.numbers import ready
from ..sampling.numbers.random import philox
from .geometry import Geometry
from .visibility import Polygons, between, is_triangle, point_of, records_of


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
    UInt32 = types.UInt32
    words = [upload(UInt32, (keys >> np.uint64(part)).astype(np.uint32)) for part in (0, 32)]
    rows = [upload(UInt32, ends.astype(np.uint32)) for ends in (source, receiver)]
    lane = dr.arange(UInt32, m * rays)
    pair = lane // dr.opaque(UInt32, rays)
    shift = philox(
        [*(dr.gather(UInt32, word, pair) for word in words), UInt32(0), UInt32(0)],
        [dr.opaque(UInt32, seed >> part & 0xFFFFFFFF) for part in (0, 32)],
    )
    index = lane - pair * dr.opaque(UInt32, rays) + 1
    numbers = ready("sobol", types).points(index, pair, [*shift, UInt32(0)], 16)
    faces = [dr.gather(UInt32, table.faces, row) for row in rows]
    start, end = (
        point_of(types, table.records, row, (face & 1) != 0, *numbers[at : at + 2])
        for row, face, at in zip(rows, faces, (0, 2), strict=True)
    )
    found = between(geometry, start, end, faces[1] >> 1)
    dr.eval(found)
    kernel, met = (np.array(values, np.float64).reshape(m, rays) * geometry.bvh.scale**2 for values in found)
    return kernel, met
