"""Crossings: the next face on a line, what it shows to either side, and where the line goes on behind it."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...scene.model import Back
from ..geometry import Geometry
from ..hits import both_sides, patch_of
from ..ray_generation import before
from .hull import nothing_beyond

ESCAPED, LOST = 0xFFFFFFFD, 0xFFFFFFFC  # as in `line_tracer`: no patch has these numbers
PENDING, NOBODY = 0xFFFFFFFB, 0xFFFFFFFA  # not known yet; and no side looks forward, since a passing back hides all behind
CODES = NOBODY  # from here on numbers are no patches
ONE_WAY = 1 << 31  # of a patch number: `one` sees it, but it does not see `one`
SHORT = 16.0  # steps of less than so many offsets of a face do not begin anew from its coordinates


@dataclass(frozen=True)
class Crossing:
    """A face on a line.

    Attributes:
        valid: there is a face.
        near, far: the patch on the side where the line comes from, and on that where it goes on; LOST for an absorbing
            back, and near is ESCAPED where there is no face.
        near_passes, far_passes: that side is a back that lets lines pass, and ``near`` or ``far`` has no meaning.
        origin: where the line goes on: behind the face.
        free: nothing lies behind the face.
    """

    valid: Any
    near: Any
    far: Any
    near_passes: Any
    far_passes: Any
    origin: Any
    free: Any


@dataclass(frozen=True, eq=False)
class Crossings:
    """The faces of a scene, for lines that go on through them."""

    geometry: Geometry

    def prepare(self) -> None:
        """Make what `next` reads, before any loop is recorded (`recorded.not_recorded`)."""
        self.geometry.prepare_hits()
        _ = self.records

    @cached_property
    def records(self):
        """Origin, edges, normal, whether there is nothing in front and behind, and the plane's offset: (n_faces * 16,) Float."""
        geometry = self.geometry
        origin, first, second = geometry.faces.frames
        free, least = nothing_beyond(geometry), geometry.faces.plane_offsets[:, None]
        record = np.concatenate([origin, first, second, geometry.faces.normals, free, least, np.zeros_like(least)], axis=1)
        return upload(self.geometry.device.types.Float, record.astype(np.float32))

    def next(self, origin, direction, active, *, coherent: bool = False) -> Crossing:
        """Return the first face from ``origin`` on; called in a kernel.

        Lines go on from the point with the hit's coordinates on the face, which is as exact as the face's own corners. The point
        at the hit's distance along the line is as inexact as the line is long, and may lie before a small face near the centre.

        A line that meets the edge of two faces, but for rounding, crosses both within a few offsets. The point on the second one
        may lie before the first again, and so on without end. After so short a step the line goes on from where it was, one
        offset on: so it never goes back.
        """
        geometry = self.geometry
        types = geometry.device.types
        hit, turned = both_sides(geometry, origin, direction, coherent, active)
        near = patch_of(geometry, hit, LOST, ESCAPED)
        far = patch_of(geometry, turned, LOST, ESCAPED)
        face = dr.gather(types.UInt32, geometry.faces.primitive_faces, hit.primitive, hit.valid)
        block = dr.gather(types.Array44f, self.records, face, hit.valid)
        words = [block[i // 4][i % 4] for i in range(16)]
        corner, first, second, normal = (types.Array3f(*words[at : at + 3]) for at in range(0, 12, 3))
        place = corner + first * dr.clip(hit.u, 0, 1) + second * dr.clip(hit.v, 0, 1)
        behind = dr.select(hit.front, -normal, normal)
        onward = before(place, behind, words[14])
        offset = dr.norm(onward - place)
        beside = origin + direction * (hit.distance + offset) + behind * offset
        onward = dr.select(hit.distance < SHORT * offset, beside, onward)
        free = hit.valid & (dr.select(hit.front, words[13], words[12]) > 0)
        return Crossing(
            hit.valid, near, far, hit.back(Back.PASSES), turned.back(Back.PASSES), dr.select(hit.valid, onward, origin), free
        )
