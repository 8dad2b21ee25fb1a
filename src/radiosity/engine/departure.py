"""In a kernel: how lines leave patches and faces."""

import drjit as dr

from ..method.lines.local import hemisphere, triangle
from .geometry import COLUMN_BITS, INVERTED, QUAD, Geometry

MASK = (1 << COLUMN_BITS) - 1
BACK = 1 << 31  # of a face number: its back


def local_line(geometry: Geometry, record, numbers):
    """Origin and direction (three floats each, the caster's coordinates) of a local line, from its patch's record and four
    numbers: two of direction, two of position."""
    face, place = record
    return leave(geometry, face, *position(geometry, place, numbers[2], numbers[3]), numbers)


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


def leave(geometry: Geometry, face, s, t, numbers):
    """Origin and cosine distributed direction of a line from a point of a face (top bit: its back), coordinates in cells."""
    types = geometry.device.types
    Float = types.Float
    front = face < BACK
    block = dr.gather(types.Array44f, geometry.face_records, face & (BACK - 1))  # one read of 16 words, not four of four
    words = [block[i // 4][i % 4] for i in range(16)]
    origin, first, second, normal, tangent = (types.Array3f(*words[at : at + 3]) for at in range(0, 15, 3))
    side = dr.select(front, Float(1), Float(-1))
    dx, dy, dz = hemisphere(numbers[0], numbers[1])
    bitangent = dr.cross(normal, tangent)
    direction = tangent * dx + bitangent * dy + normal * (dz * side)
    point = origin + first * s + second * t + normal * (words[15] * side)
    return point, direction
