"""Spans without chords: each begins at a uniform point of all sides that radiate, in a cosine distributed direction.

The density of such a line's two ends is cos cos' / (pi r^2 A), where A is the area of all sides. It is the same with the ends
exchanged, and it is the density of a span of global lines. So one trace gives a span, and both its ends count.
"""

from dataclasses import dataclass
from functools import cached_property

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...device.recorded import loop
from ...sampling.hemisphere import triangle
from ...scene.model import Back
from ..faces import COLUMN_BITS, QUAD
from ..geometry import Geometry
from ..hits import Hit, first_hit, patch_of
from ..ray_generation import BACK, MASK, Frame
from .crossing import CODES, ESCAPED, LOST, ONE_WAY, Crossings

MOST_CELLS = 1 << 20
GOLDEN = 0x9E3779B9


@dataclass(frozen=True, eq=False)
class Surfaces:
    """The sides that radiate, to be drawn by area."""

    geometry: Geometry

    @cached_property
    def sides(self) -> np.ndarray:
        """Face numbers, the top bit for a back, in the order of patches: (n_sides,) int64."""
        back = self.geometry.scene.back == Back.RADIATES
        face = np.repeat(np.arange(len(back)), 1 + back)
        second = np.concatenate([[False], face[1:] == face[:-1]])
        return face + np.where(second, BACK, 0)

    @cached_property
    def area(self) -> float:
        """Area of all sides, m²."""
        return float(self._areas.sum())

    @property
    def _areas(self) -> np.ndarray:
        return self.geometry.scene.area[self.sides & (BACK - 1)]

    @cached_property
    def ends(self) -> np.ndarray:
        """The last 32-bit word of each side's interval, (n_sides,) uint32."""
        share = np.cumsum(self._areas) / self._areas.sum()
        share[-1] = 1.0
        return (np.ceil(share * 2.0**32) - 1).clip(0, 2**32 - 1).astype(np.uint32)

    @cached_property
    def bits(self) -> int:
        """Binary logarithm of the number of cells of the guide table."""
        return int(np.clip(np.ceil(np.log2(4 * len(self.sides))), 4, np.log2(MOST_CELLS)))

    @cached_property
    def _tables(self):
        """Three tables on the device: ends of intervals, side of the first word of each cell, face of each side."""
        UInt32 = self.geometry.device.types.UInt32
        first_words = np.arange(1 << self.bits, dtype=np.uint64) << np.uint64(32 - self.bits)
        guide = np.searchsorted(self.ends, first_words.astype(np.uint32), side="left")
        return upload(UInt32, self.ends), upload(UInt32, guide.astype(np.uint32)), upload(UInt32, self.sides.astype(np.uint32))

    @cached_property
    def _places(self):
        """First patch, and cell counts and flags as in hit records, (n_faces * 2,) UInt32."""
        scene, patches = self.geometry.scene, self.geometry.patches
        packed = patches.columns | (patches.rows.astype(np.int64) << COLUMN_BITS) | np.where(scene.is_quad, QUAD, 0)
        packed |= scene.back.astype(np.int64) << 30
        return upload(self.geometry.device.types.UInt32, np.column_stack([patches.first[:-1], packed]).astype(np.uint32))

    def choose(self, word):
        """Return the side whose interval holds each word; called in a kernel."""
        UInt32 = self.geometry.device.types.UInt32
        ends, guide, sides = self._tables
        side = dr.gather(UInt32, guide, word >> (32 - self.bits))
        (side,) = loop((side,), lambda side: dr.gather(UInt32, ends, side) < word, lambda side: (side + 1,))
        return dr.gather(UInt32, sides, side)

    def word(self, numbers, index):
        """Return 32 bits that choose a side; called in a kernel. A number has 24; the index, spread evenly, gives the rest."""
        return (self.geometry.device.types.UInt32(numbers[4] * 2.0**24) << 8) | ((index * GOLDEN) >> 24)

    def leave(self, numbers, index):
        """Return patch, origin and direction of a line from a uniform point of all sides; called in a kernel."""
        geometry = self.geometry
        types = geometry.device.types
        Float = types.Float
        face = self.choose(self.word(numbers, index))
        first, packed = dr.gather(types.Array2u, self._places, face & (BACK - 1))
        s, t = numbers[2], numbers[3]
        if not geometry.all_quads:
            folded, quad = triangle(s, t), (packed & QUAD) != 0
            s, t = dr.select(quad, s, folded[0]), dr.select(quad, t, folded[1])
        yes = dr.full(types.Bool, True, dr.width(face))
        none = dr.zeros(Float, dr.width(face))
        patch = patch_of(geometry, Hit(yes, face, s, t, face < BACK, none, first, packed), LOST, ESCAPED)
        columns, rows = Float(packed & MASK), Float((packed >> COLUMN_BITS) & MASK)
        return patch, *Frame.of(geometry, face).leave(s * columns, t * rows, numbers)

    def spans(self, crossings: Crossings, points, lane, count: int):
        """Return the number of the line, one end and the other, of each span.

        A line that meets no patch, or a patch that does not look back, was found from this end only: it counts twice.

        Args:
            points: gives the numbers of lanes. lane: a permutation of the lanes.
        """
        types = self.geometry.device.types
        patch, origin, direction = self.leave(points(lane), lane)
        if self.geometry.some_backs_pass:
            other = self._through(crossings, origin, direction)
        else:
            other = patch_of(self.geometry, first_hit(self.geometry, origin, direction), LOST, ESCAPED)
        ends = dr.opaque(types.UInt32, 0, max(count, 2)), dr.opaque(types.UInt32, 0, max(count, 2))
        for end, values in zip(ends, (patch, other), strict=True):
            dr.scatter(end, values, lane)
        dr.eval(ends)
        one, other = (np.array(frozen(end))[:count] for end in ends)
        line = np.arange(count, dtype=np.uint32)
        single = other >= ONE_WAY
        if single.any():
            rows = np.repeat(line, 1 + single)
            line, one, other = rows, one[rows], other[rows]
        return line, one, other

    def _through(self, crossings: Crossings, origin, direction):
        """Return the patch that lines hit, with ONE_WAY where they passed a back; called in a kernel."""
        crossings.prepare()
        types = self.geometry.device.types

        def body(origin, going, passed, seen):
            face = crossings.next(origin, direction, going)
            seen = dr.select(going & ~face.near_passes, face.near, seen)
            going = going & face.near_passes
            return dr.select(going, face.origin, origin), going, passed | going, seen

        width = dr.width(direction)
        yes, no = dr.full(types.Bool, True, width), dr.full(types.Bool, False, width)
        state = (types.Array3f(origin), yes, no, dr.full(types.UInt32, ESCAPED, width))
        _, _, passed, seen = loop(state, lambda origin, going, passed, seen: going, body)
        return dr.select(passed & (seen < CODES), seen | ONE_WAY, seen)
