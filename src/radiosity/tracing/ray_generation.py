"""In a kernel: how lines leave patches and faces."""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from ..sampling.hemisphere import hemisphere, triangle
from .faces import COLUMN_BITS, INVERTED, OFFSET, QUAD
from .geometry import Geometry

MASK = (1 << COLUMN_BITS) - 1
BACK = 1 << 31  # of a face number: its back
COLUMN, ROW = 0xF1554989, 0xEB99116D  # steps of a place, see `place_number`; odd


def local_line(geometry: Geometry, record, numbers):
    """Origin and direction (three floats each, the caster's coordinates) of a local line, from its patch's record and four
    numbers: two of direction, two of position."""
    return local_lines(geometry, record)(numbers)


def local_lines(geometry: Geometry, record):
    """As `local_line`, for lines of one patch that are fired in a loop: made before it, and called in it with the numbers."""
    face, place = record
    frame = Frame.of(geometry, face)
    return lambda numbers: frame.leave(*position(geometry, place, numbers[2], numbers[3]), numbers)


def place_number(record):
    """UInt32 of a patch, from its record: face + column * `COLUMN` + row * `ROW`, modulo 2^32, and a bit for inverted triangles.

    It is the place in the Kronecker sequence that moves the patch's numbers (`AbstractNumbers.of_patch`). The steps were searched
    for among 60 000 pairs of random ones: no wave over the square of directions of up to 12 periods comes to rest, or nearly,
    along the columns and rows of a face. Patch numbers have no such steps: with 34 columns a face's mean errs 1.5 times as much.
    """
    face, place = record
    return face + (place & MASK) * COLUMN + ((place >> COLUMN_BITS) & MASK) * ROW + (place & INVERTED)


def position(geometry: Geometry, place, x, y):
    """Face coordinates, in cells, of a uniform point of a patch."""
    Float = geometry.device.types.Float
    s, t = x, y
    if not geometry.all_quads:
        s, t = triangle(x, y)
        quad = (place & QUAD) != 0
        if not geometry.whole_faces:
            inverted = (place & INVERTED) != 0
            s, t = dr.select(inverted, 1 - s, s), dr.select(inverted, 1 - t, t)
        s, t = dr.select(quad, x, s), dr.select(quad, y, t)
    if not geometry.whole_faces:
        s, t = s + Float(place & MASK), t + Float((place >> COLUMN_BITS) & MASK)
    return s, t


@dataclass(frozen=True)
class Frame:
    """Of a face on the side that lines leave from, see `Geometry.face_records`: origin, edges of a cell, tangents, normal, which
    points away from the side where ``side`` is -1, and the least distance of the lines' origins from the face."""

    origin: Any
    first: Any
    second: Any
    tangent: Any
    bitangent: Any
    normal: Any
    side: Any
    offset: Any

    @staticmethod
    def of(geometry: Geometry, face) -> "Frame":
        """Of a face number, its top bit the back."""
        types = geometry.device.types
        side = dr.select(face < BACK, types.Float(1), types.Float(-1))
        block = dr.gather(types.Array44f, geometry.face_records, face & (BACK - 1))  # one read of 16 words, not four of four
        words = [block[i // 4][i % 4] for i in range(16)]
        origin, first, second, normal, tangent = (types.Array3f(*words[at : at + 3]) for at in range(0, 15, 3))
        return Frame(origin, first, second, tangent, dr.cross(normal, tangent), normal, side, words[15])

    def leave(self, s, t, numbers):
        """Origin and cosine distributed direction of a line from a point of the face, coordinates in cells."""
        dx, dy, dz = hemisphere(numbers[0], numbers[1])
        direction = self.tangent * dx + self.bitangent * dy + self.normal * (dz * self.side)
        return before(self.origin + self.first * s + self.second * t, self.normal * self.side, self.offset), direction


def before(point, normal, least):
    """Where lines go on in front of a point of a face: some ulps of the numbers there away, so that no rounding leads back.

    Args:
        normal: of unit length, towards the side where lines go on. least: the face's plane offset.
    """
    size = dr.maximum(dr.maximum(dr.abs(point[0]), dr.abs(point[1])), dr.abs(point[2]))
    return point + normal * dr.maximum(least, size * OFFSET)
