"""Hits: functions, called in kernels, that lead from a line to the patch that it hits."""

from dataclasses import dataclass, replace
from typing import Any

import drjit as dr

from ..device.backend import classes
from ..device.recorded import loop
from ..scene.model import Back
from .faces import BACK_BIT, COLUMN_BITS, NORMAL_BITS, NORMAL_ONE, QUAD, SECOND_HALF
from .geometry import TIED, Geometry
from .ray_generation import BACK, MASK, before, local_line, local_lines

NORMAL_MASK = (1 << NORMAL_BITS) - 1

__all__ = ["Hit", "first_hit", "local_line", "local_lines", "patch_of", "place_of"]


@dataclass(frozen=True)
class Hit:
    """The hits of lines: primitive, face coordinates, side, distance in the BVH's units, and the hit record's first words."""

    valid: Any
    primitive: Any
    u: Any
    v: Any
    front: Any
    distance: Any
    first: Any
    packed: Any

    def back(self, kind: Back):
        """Return a mask of the lines that came from behind to a face whose back is of this kind."""
        return self.valid & ~self.front & ((self.packed >> BACK_BIT) == int(kind))

    @property
    def passes(self):
        """Mask of the lines that go on through the face."""
        return self.back(Back.PASSES) | (self.valid & ((self.packed >> BACK_BIT) == int(Back.OPEN)))


def first_hit(geometry: Geometry, origin, direction, *, coherent: bool = False, active=True, own=()) -> Hit:
    """Trace lines to the first side that does not let them pass.

    Args:
        own: two Floats of each line, for panes, where many lines have the same origin and direction (`Panes.words`).
    """
    geometry.prepare_hits()
    panes = geometry.panes
    if panes is None and not geometry.some_backs_pass:
        return _hit(geometry, origin, direction, coherent, active)[0]
    words = None if panes is None else panes.words(origin, direction, own)
    types = geometry.device.types
    Float, Bool, UInt32 = types.Float, types.Bool, types.UInt32

    def body(origin, going, hit):
        new, normal = _hit(geometry, origin, direction, coherent, going)
        passes = going & new.passes
        if panes is not None:
            met = going & new.valid
            face = dr.gather(UInt32, geometry.faces.primitive_faces, new.primitive, met)
            passes |= panes.passed(words, face, met, direction, normal)
        done = going & ~passes
        travelled = dr.select(going, hit[5] + new.distance, hit[5])
        kept = [dr.select(done, value, old) for value, old in zip(_fields(new), hit, strict=True)]
        # go on in front of the face just passed, on the side that the line leads to
        least = dr.gather(
            Float, geometry.faces.offsets, dr.gather(UInt32, geometry.faces.primitive_faces, new.primitive, passes), passes
        )
        onward = normal * dr.select(new.front, Float(-1.0 / NORMAL_ONE), Float(1.0 / NORMAL_ONE))
        step = before(origin + direction * new.distance, onward, least)
        return dr.select(passes, step, origin), passes, (*kept[:5], travelled, *kept[6:])

    width = dr.width(origin, direction)
    none, zero, whole = dr.full(Bool, False, width), dr.zeros(Float, width), dr.zeros(UInt32, width)
    state = (types.Array3f(origin), dr.full(Bool, True, width) & active, (none, whole, zero, zero, none, zero, whole, whole))
    _, _, hit = loop(state, lambda origin, going, hit: going, body)
    return Hit(*hit)


def _fields(hit: Hit):
    return hit.valid, hit.primitive, hit.u, hit.v, hit.front, hit.distance, hit.first, hit.packed


def _hit(geometry: Geometry, origin, direction, coherent: bool, active):
    """Return the nearest hit, and the face's normal, not normalised."""
    hit, normal, tied = _found(geometry, origin, direction, coherent, active)
    if geometry.ties is None:
        return hit, normal
    ((met, fields, along),) = geometry.ties.meet(hit, tied, origin, direction)
    return _chosen(hit, met, fields), dr.select(met, along, normal)


def both_sides(geometry: Geometry, origin, direction, coherent: bool, active) -> tuple[Hit, Hit]:
    """Return the nearest hit, and what a line from the other side would hit there: another face, where two lie in one plane."""
    hit, _, tied = _found(geometry, origin, direction, coherent, active)
    turned = replace(hit, front=~hit.front)
    if geometry.ties is None:
        return hit, turned
    near, far = geometry.ties.meet(hit, tied, origin, direction, beyond=True)
    return _chosen(hit, *near[:2]), _chosen(turned, *far[:2])


def _chosen(hit: Hit, met, fields) -> Hit:
    return Hit(hit.valid, *(dr.select(met, new, old) for new, old in zip(fields[1:], _fields(hit)[1:], strict=True)))


def _found(geometry: Geometry, origin, direction, coherent: bool, active):
    """Return the nearest hit in the BVH, the face's normal, and whether the face shares its plane with others."""
    types = geometry.device.types
    Float, Int32 = types.Float, types.Int
    mi, mitsuba_scene = classes(geometry.device), geometry.bvh.scene
    ray = mi.Ray3f(mi.Point3f(origin), mi.Vector3f(direction))
    found = mitsuba_scene.ray_intersect_preliminary(ray, coherent=coherent, active=active)
    valid = found.is_valid() & active
    place = found.prim_index >> 1 if geometry.all_quads else found.prim_index
    first, packed, low, high = dr.gather(types.Array4u, geometry.hit_records, place, valid)
    y = (low >> NORMAL_BITS) | (high << 32 - NORMAL_BITS)
    parts = (low, y, high >> 2 * NORMAL_BITS - 32)
    normal = types.Array3f(*(Float(Int32(part & NORMAL_MASK) - (NORMAL_ONE + 1)) for part in parts))
    half = ((found.prim_index & 1) if geometry.all_quads else (packed & SECOND_HALF)) != 0
    # Embree leaves what is in memory there where a line hits nothing, which may be NaN, and NaN times 0 is no 0
    u, v = (dr.select(valid, one, 0) for one in (found.prim_uv.x, found.prim_uv.y))
    u, v = dr.select(half, 1 - u, u), dr.select(half, 1 - v, v)
    hit = Hit(valid, found.prim_index, u, v, dr.dot(direction, normal) < 0, found.t, first, packed)
    return hit, normal, valid & ((high & TIED) != 0)


def patch_of(geometry: Geometry, hit: Hit, absorbed: int, escaped: int):
    """Return the patch that lines hit, as in `patches.cells.number`; or the code for an absorbing back or for no hit."""
    types = geometry.device.types
    Float, UInt32 = types.Float, types.UInt32
    if geometry.whole_faces:
        return _side(geometry, hit, hit.first, types.UInt32(1), absorbed, escaped)
    columns, rows = hit.packed & MASK, (hit.packed >> COLUMN_BITS) & MASK
    x, y = dr.maximum(hit.u, 0) * Float(columns), dr.maximum(hit.v, 0) * Float(rows)
    row = dr.minimum(UInt32(y), rows - 1)
    if geometry.all_quads:
        cell = row * columns + dr.minimum(UInt32(x), columns - 1)
    else:
        quad = (hit.packed & QUAD) != 0
        limit = dr.select(quad, columns, columns - row)
        column = dr.minimum(UInt32(x), limit - 1)
        inverted = ((x - Float(column)) + (y - Float(row)) > 1) & (column + 1 < limit)
        triangle_cell = row * (2 * columns - row) + 2 * column + dr.select(inverted, UInt32(1), UInt32(0))
        cell = dr.select(quad, row * columns + column, triangle_cell)
    return _side(geometry, hit, hit.first + cell, columns * rows, absorbed, escaped)


def _side(geometry: Geometry, hit: Hit, patch, cells, absorbed: int, escaped: int):
    """Turn the patch in front into that on the side that lines hit, or into a code."""
    UInt32 = geometry.device.types.UInt32
    if geometry.some_backs_radiate:
        patch = dr.select(hit.back(Back.RADIATES), patch + cells, patch)
    patch = dr.select(hit.back(Back.ABSORBS), UInt32(absorbed), patch)
    return dr.select(hit.valid, patch, UInt32(escaped))


def place_of(geometry: Geometry, hit: Hit):
    """Return where lines hit: the face (top bit: its back), and face coordinates in cells, as `ray_generation.Frame` takes
    them."""
    types = geometry.device.types
    Float, UInt32 = types.Float, types.UInt32
    face = dr.gather(UInt32, geometry.faces.primitive_faces, hit.primitive, hit.valid)
    if geometry.some_backs_radiate:
        face = dr.select(hit.back(Back.RADIATES), face | BACK, face)
    s, t = dr.clip(hit.u, 0, 1), dr.clip(hit.v, 0, 1)
    if not geometry.whole_faces:
        s, t = s * Float(hit.packed & MASK), t * Float((hit.packed >> COLUMN_BITS) & MASK)
    return face, s, t
