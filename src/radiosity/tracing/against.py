"""Lines against the light: from a point to what sends light there.

Light goes on through backs that let lines pass. So a line against it goes on through the *fronts* of such faces, each of which
adds its own light, and ends at their backs, where light that comes towards it has ended. This is the exact reverse of what random
walks do: a point receives what walks bring there.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import drjit as dr

from ..device.recorded import loop
from ..scene.model import Back
from .geometry import Geometry
from .hits import Hit, both_sides
from .ray_generation import Frame, before

Visit = Callable[..., tuple]


def light_along(geometry: Geometry, origin, direction, visit: Visit, sums: tuple, *, coherent=False, active: Any = True, own=()):
    """Visit what sends light back along lines, the nearest first; called in a kernel.

    Args:
        visit: ``visit(hit, stops, met, *sums)`` returns new sums. The hit's distance is that from the line's origin. Only lines
            with ``met`` are there, and those with ``stops`` end there, on a face or in empty space.
        sums: to begin with.
        own: see `first_hit`.
    """
    panes, types = geometry.panes, geometry.device.types
    words = None if panes is None else panes.words(origin, direction, own)
    Float, Bool, UInt32 = types.Float, types.Bool, types.UInt32

    def body(origin, going, travelled, *sums):
        near, far = both_sides(geometry, origin, direction, coherent, going)
        face = dr.gather(UInt32, geometry.faces.primitive_faces, near.primitive, going & near.valid)
        frame, passed = Frame.of(geometry, face), dr.full(Bool, False, dr.width(going))
        if panes is not None:
            passed = panes.passed(words, face, going & near.valid, direction, frame.normal)
        goes_on = passed | (going & far.valid & far.passes)
        distance = travelled + near.distance
        met = going & ~passed
        sums = visit(replace(near, distance=distance), met & ~goes_on, met, *sums)
        onward = frame.normal * dr.select(near.front, Float(-1), Float(1))
        step = before(origin + direction * near.distance, onward, frame.offset)
        return dr.select(goes_on, step, origin), goes_on, dr.select(going, distance, travelled), *sums

    width = dr.width(origin, direction)
    state = (types.Array3f(origin), dr.full(Bool, True, width) & active, dr.zeros(Float, width), *sums)
    _, _, _, *found = loop(state, lambda origin, going, *_: going, body)
    return found


def sends(hit: Hit):
    """Return which hits are on sides that may send light: fronts, and backs that radiate."""
    return hit.valid & (hit.front | hit.back(Back.RADIATES))
