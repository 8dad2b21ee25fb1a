"""In a kernel: from a patch and four numbers to a line, and from a line to the patch it lands on."""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from ..method.lines.local import hemisphere, triangle
from .device import entered
from .geometry import ABSORBS, COLUMN_BITS, INVERTED, PASSES, QUAD, SECOND_HALF, Geometry

MASK = (1 << COLUMN_BITS) - 1


def local_line(geometry: Geometry, patch, numbers):
    """Origin and direction (three floats each, the caster's coordinates) of a local line of a patch (UInt32)."""
    types = geometry.device.types
    Float = types.Float
    face, place = dr.gather(types.Array2u, geometry.patch_records, patch)
    front = face < (1 << 31)
    face = face & 0x7FFFFFFF
    words = [dr.gather(types.Array4f, geometry.face_records, face * 4 + i) for i in range(4)]
    origin, first, second, normal, tangent = (
        types.Array3f(*(words[i // 4][i % 4] for i in range(at, at + 3))) for at in range(0, 15, 3)
    )
    side = dr.select(front, Float(1), Float(-1))
    x, y = numbers[2], numbers[3]
    s, t = triangle(x, y)
    inverted = (place & INVERTED) != 0
    quad = (place & QUAD) != 0
    s, t = dr.select(inverted, 1 - s, s), dr.select(inverted, 1 - t, t)
    s, t = dr.select(quad, x, s), dr.select(quad, y, t)
    column, row = Float(place & MASK), Float((place >> COLUMN_BITS) & MASK)
    dx, dy, dz = hemisphere(numbers[0], numbers[1])
    bitangent = dr.cross(normal, tangent)
    direction = tangent * dx + bitangent * dy + normal * (dz * side)
    point = origin + first * (column + s) + second * (row + t) + normal * (words[3][3] * side)
    return point, direction


@dataclass(frozen=True)
class Landing:
    """Where lines land: face, face coordinates, side, distance in the caster's units, and the hit record's words."""

    valid: Any
    face: Any
    u: Any
    v: Any
    front: Any
    distance: Any
    record: Any
    packed: Any


def land(geometry: Geometry, origin, direction, *, coherent: bool = False, active=True) -> Landing:
    """Trace lines to the first side that does not let them pass."""
    if not geometry.some_backs_pass:
        return _hit(geometry, origin, direction, coherent, active)
    types = geometry.device.types
    Float, Bool, UInt32 = types.Float, types.Bool, types.UInt32

    def body(origin, direction, going, distance, valid, face, u, v, front, words, packed):
        hit = _hit(geometry, origin, direction, coherent, going)
        passes = going & hit.valid & ~hit.front & (hit.record[2] == PASSES)
        done = going & ~passes
        distance = dr.select(going, distance + hit.distance, distance)
        valid = dr.select(done, hit.valid, valid)
        face, u, v = dr.select(done, hit.face, face), dr.select(done, hit.u, u), dr.select(done, hit.v, v)
        front, packed = dr.select(done, hit.front, front), dr.select(done, hit.packed, packed)
        words = dr.select(done, hit.record, words)
        # go on in front of the face just passed, from the side of its normal
        step = origin + direction * hit.distance + _normal(types, hit) * hit.offset
        return dr.select(passes, step, origin), direction, passes, distance, valid, face, u, v, front, words, packed

    width = dr.width(origin, direction)
    state = (
        types.Array3f(origin), types.Array3f(direction), Bool(active) & dr.full(Bool, True, width), dr.zeros(Float, width),
        dr.full(Bool, False, width), dr.zeros(UInt32, width), dr.zeros(Float, width), dr.zeros(Float, width),
        dr.full(Bool, False, width), dr.zeros(types.Array4u, width), dr.zeros(UInt32, width),
    )  # fmt: skip
    state = dr.while_loop(state, lambda *s: s[2], body, mode="symbolic")
    _, _, _, distance, valid, face, u, v, front, words, packed = state
    return Landing(valid, face, u, v, front, distance, words, packed)


@dataclass(frozen=True)
class _Hit(Landing):
    normal: Any
    offset: Any


def _normal(types, hit: "_Hit"):
    return hit.normal


def _hit(geometry: Geometry, origin, direction, coherent: bool, active) -> _Hit:
    types = geometry.device.types
    Float = types.Float
    with entered(geometry.device) as mi:
        ray = mi.Ray3f(mi.Point3f(origin), mi.Vector3f(direction))
        found = geometry.tree.caster.ray_intersect_preliminary(ray, coherent=coherent, active=active)
    valid = found.is_valid() & active
    record = dr.gather(types.Array4u, geometry.hit_records, found.prim_index * 2, valid)
    rest = dr.gather(types.Array4u, geometry.hit_records, found.prim_index * 2 + 1, valid)
    normal = types.Array3f(*(dr.reinterpret_array(Float, rest[i]) for i in range(3)))
    half = (record[1] & SECOND_HALF) != 0
    u, v = found.prim_uv.x, found.prim_uv.y
    return _Hit(
        valid, record[3], dr.select(half, 1 - u, u), dr.select(half, 1 - v, v), dr.dot(direction, normal) < 0, found.t,
        record, record[1], normal, dr.reinterpret_array(Float, rest[3]),
    )  # fmt: skip


def patch_of(geometry: Geometry, hit: Landing, absorbed: int, escaped: int):
    """The patch that lines land on, as in `patches.cells.number`; or the code for an absorbing back or for none."""
    types = geometry.device.types
    Float, UInt32 = types.Float, types.UInt32
    columns, rows = hit.packed & MASK, (hit.packed >> COLUMN_BITS) & MASK
    quad = (hit.packed & QUAD) != 0
    x, y = dr.maximum(hit.u, 0) * Float(columns), dr.maximum(hit.v, 0) * Float(rows)
    row = dr.minimum(UInt32(y), rows - 1)
    limit = dr.select(quad, columns, columns - row)
    column = dr.minimum(UInt32(x), limit - 1)
    inverted = ((x - Float(column)) + (y - Float(row)) > 1) & (column + 1 < limit)
    cell = dr.select(
        quad, row * columns + column, row * (2 * columns - row) + 2 * column + dr.select(inverted, UInt32(1), UInt32(0))
    )
    first = dr.select(hit.front, hit.record[0], hit.record[2])
    patch = dr.select(first == ABSORBS, UInt32(absorbed), first + cell)
    return dr.select(hit.valid, patch, UInt32(escaped))
