"""Ray generation: functions, called in kernels, that make the first ray of a line from a patch or face."""

from dataclasses import dataclass, replace
from typing import Any

import drjit as dr

from ..sampling.hemisphere import hemisphere, triangle
from .faces import COLUMN_BITS, INVERTED, OFFSET, QUAD
from .geometry import Geometry

MASK = (1 << COLUMN_BITS) - 1
BACK = 1 << 31  # of a face number: its back
COLUMN, ROW = 0xF1554989, 0xEB99116D  # steps of a place, see `place_number`; odd


def local_line(geometry: Geometry, record, numbers):
    """Return origin and direction (three floats each, in the BVH's coordinates) of a local line.

    Args:
        record: of its patch. numbers: four, two of direction and two of position.
    """
    return local_lines(geometry, record)(numbers)


def local_lines(geometry: Geometry, record):
    """Return a function from numbers to local lines, see `local_line`; made before a loop over lines of a patch, called in it."""
    face, place = record
    frame = Frame.of(geometry, face)
    return lambda numbers: frame.leave(*position(geometry, place, numbers[2], numbers[3]), numbers)


def place_number(record):
    """Return face + column * `COLUMN` + row * `ROW`, modulo 2^32, and a bit for inverted triangles: UInt32, from patch records.

    It is the patch's place in the Kronecker sequence that moves its numbers (`AbstractNumbers.of_patch`). The steps are the best
    of 60 000 random pairs: no wave of up to 12 periods over the square of directions is constant, or nearly so, along the
    columns and rows of a face. Patch numbers have no such steps: with 34 columns, the error of a face's mean is 1.5 times as
    large.
    """
    face, place = record
    return face + (place & MASK) * COLUMN + ((place >> COLUMN_BITS) & MASK) * ROW + (place & INVERTED)


def position(geometry: Geometry, place, x, y):
    """Return face coordinates, in cells, of a uniform point of a patch."""
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
    """A face and the side that lines leave from, see `Geometry.face_records`.

    It has the origin, the edges of a cell, the tangents, and the normal, which points away from the side where ``side`` is -1.
    ``offset`` is the least distance of the lines' origins from the face. ``turned``, where it is not None, makes the squared sine
    of a line's angle of a number: lines of glass are not cosine distributed (`tracing.angles`).
    """

    origin: Any
    first: Any
    second: Any
    tangent: Any
    bitangent: Any
    normal: Any
    side: Any
    offset: Any
    turned: Any = None

    @staticmethod
    def of(geometry: Geometry, face) -> "Frame":
        """Make the frame of a face number, whose top bit is the back."""
        frame = Frame.read(geometry.device.types, geometry.face_records, face)
        angles = None if geometry.panes is None else geometry.panes.angles
        if angles is None:
            return frame
        return replace(frame, turned=lambda number: angles.direction(face & (BACK - 1), number))

    @staticmethod
    def read(types, records, face) -> "Frame":
        """Make the frame of a number, whose top bit is the back, from records as those of faces."""
        side = dr.select(face < BACK, types.Float(1), types.Float(-1))
        block = dr.gather(types.Array44f, records, face & (BACK - 1))  # one read of 16 words, not four of four
        words = [block[i // 4][i % 4] for i in range(16)]
        origin, first, second, normal, tangent = (types.Array3f(*words[at : at + 3]) for at in range(0, 15, 3))
        return Frame(origin, first, second, tangent, dr.cross(normal, tangent), normal, side, words[15])

    def leave(self, s, t, numbers):
        """Return origin and cosine distributed direction of a line from a point of the face, whose coordinates are in cells."""
        dx, dy, dz = hemisphere(numbers[0], numbers[1] if self.turned is None else self.turned(numbers[1]))
        direction = self.tangent * dx + self.bitangent * dy + self.normal * (dz * self.side)
        return before(self.origin + self.first * s + self.second * t, self.normal * self.side, self.offset), direction


def before(point, normal, least):
    """Return where lines go on in front of a point of a face: some ulps of the coordinates away, so that no rounding leads back.

    Args:
        normal: of unit length, towards the side where lines go on. least: the face's plane offset.
    """
    size = dr.maximum(dr.maximum(dr.abs(point[0]), dr.abs(point[1])), dr.abs(point[2]))
    return point + normal * dr.maximum(least, size * OFFSET)
