"""Entrance: where lines enter a scene whose hull is a box, as that of most rooms. A table finds it, without a trace.

A line that comes from outside meets nothing before the box about the scene. Where a face lies in a side of that box, and its
back absorbs or lets lines pass, the line's first crossing is known from the point of entrance.
"""

from dataclasses import dataclass
from functools import cached_property

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...scene.model import Back
from ..faces import COLUMN_BITS, QUAD
from ..hits import Hit, patch_of
from ..ray_generation import before
from .crossing import ESCAPED, LOST, Crossings

CELLS = 128  # of a table, along each edge of each side of the box
NONE = 0xFFFFFFFF
INSIDE = 1e-5  # of a face: lines are traced where they enter nearer its edges than this, and where the table has no face


@dataclass(frozen=True, eq=False)
class Entrance:
    """The faces in the sides of a scene's box.

    Attributes:
        crossings: the scene's faces.
        low, high: (3,) corners of the box, in the BVH's units.
    """

    crossings: Crossings
    low: np.ndarray
    high: np.ndarray

    @cached_property
    def faces(self) -> np.ndarray:
        """The face that holds each cell's centre, for each axis on the low and the high side: (6, CELLS, CELLS) uint32."""
        geometry = self.crossings.geometry
        origin, first, second = geometry.faces.frames
        offset = geometry.faces.offset(np.arange(len(origin)), origin)
        quad, back = geometry.scene.is_quad, geometry.scene.back
        table = np.full((6, CELLS, CELLS), NONE, np.uint32)
        inward = np.cross(first, second)
        for axis in range(3):
            b, c = (axis + 1) % 3, (axis + 2) % 3
            for high in (0, 1):
                plane = (self.high if high else self.low)[axis]
                flat = (np.abs(origin[:, axis] - plane) <= offset) & (first[:, axis] == 0) & (second[:, axis] == 0)
                flat &= (back != Back.RADIATES) & ((inward[:, axis] < 0) == bool(high))
                if geometry.ties is not None:
                    flat &= ~geometry.ties.flagged  # what lines meet first there is found by the line
                for face in np.flatnonzero(flat):
                    _paint(
                        table[2 * axis + high],
                        face,
                        origin[face][[b, c]],
                        first[face][[b, c]],
                        second[face][[b, c]],
                        quad[face],
                        self.low[[b, c]],
                        self.high[[b, c]],
                    )
        return table

    @cached_property
    def known(self) -> bool:
        """True where some cell holds a face."""
        return bool((self.faces != NONE).any())

    @cached_property
    def _tables(self):
        """The faces of all cells; and each face's first patch, and cell counts and flags as in hit records."""
        geometry = self.crossings.geometry
        scene, patches = geometry.scene, geometry.patches
        packed = patches.columns | (patches.rows.astype(np.int64) << COLUMN_BITS) | np.where(scene.is_quad, QUAD, 0)
        packed |= scene.back.astype(np.int64) << 30
        UInt32 = geometry.device.types.UInt32
        return upload(UInt32, self.faces), upload(UInt32, np.column_stack([patches.first[:-1], packed]).astype(np.uint32))

    def find(self, point, direction, axis):
        """Return whether the first face is known, the patch on its inner side, and where lines go on behind it.

        It is called in a kernel.

        Args:
            point: where lines enter the box. axis: UInt32, the axis across which the side lies that they enter by.
        """
        geometry = self.crossings.geometry
        types = geometry.device.types
        Float, UInt32 = types.Float, types.UInt32
        faces, places = self._tables
        low, high = ([dr.opaque(Float, float(x)) for x in corner] for corner in (self.low, self.high))
        cells = [dr.clip((point[i] - low[i]) * (CELLS / (high[i] - low[i])), 0, CELLS - 1) for i in range(3)]
        b = dr.select(axis == 0, cells[1], dr.select(axis == 1, cells[2], cells[0]))
        c = dr.select(axis == 0, cells[2], dr.select(axis == 1, cells[0], cells[1]))
        going = dr.select(axis == 0, direction[0], dr.select(axis == 1, direction[1], direction[2]))
        side = 2 * axis + dr.select(going < 0, UInt32(1), UInt32(0))
        face = dr.gather(UInt32, faces, (side * CELLS + UInt32(b)) * CELLS + UInt32(c))
        there = face != NONE
        block = dr.gather(types.Array44f, self.crossings.records, face, there)
        words = [block[i // 4][i % 4] for i in range(16)]
        corner, first, second, normal = (types.Array3f(*words[at : at + 3]) for at in range(0, 12, 3))
        # coordinates of the point on the face, by the edges' dual basis
        aa, ab, bb = dr.dot(first, first), dr.dot(first, second), dr.dot(second, second)
        along = point - corner
        pa, pb = dr.dot(along, first), dr.dot(along, second)
        scale = 1 / (aa * bb - ab * ab)
        u, v = (bb * pa - ab * pb) * scale, (aa * pb - ab * pa) * scale
        number, packed = dr.gather(types.Array2u, places, face, there)
        inside = (u > INSIDE) & (v > INSIDE) & (dr.select((packed & QUAD) != 0, dr.maximum(u, v), u + v) < 1 - INSIDE)
        front = dr.full(types.Bool, True, dr.width(u))
        hit = Hit(there & inside, face, u, v, front, Float(0), number, packed)
        return hit.valid, patch_of(geometry, hit, LOST, ESCAPED), before(corner + first * u + second * v, normal, words[14])


def _paint(table, face, origin, first, second, quad, low, high) -> None:
    """Write the number of a face into the cells of one side whose centres it holds."""
    corners = np.stack([origin, origin + first, origin + second, origin + first + second * quad])
    size = (high - low) / CELLS
    begin = np.clip(np.floor((corners.min(axis=0) - low) / size), 0, CELLS).astype(int)
    end = np.clip(np.ceil((corners.max(axis=0) - low) / size), 0, CELLS).astype(int)
    x, y = (low[i] + (np.arange(begin[i], end[i]) + 0.5) * size[i] - origin[i] for i in (0, 1))
    x, y = x[:, None], y[None, :]
    area = first[0] * second[1] - first[1] * second[0]
    u, v = (x * second[1] - y * second[0]) / area, (first[0] * y - first[1] * x) / area
    holds = (u >= 0) & (v >= 0) & ((np.maximum(u, v) if quad else u + v) <= 1)
    table[begin[0] : end[0], begin[1] : end[1]][holds] = face
