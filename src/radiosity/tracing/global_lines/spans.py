"""Spans of global lines: pairs of patches that see each other.

A span is a straight piece between two sides that radiate. Its ends are uniform on patches and cosine distributed. So the other
end of a span of patch i lies on patch j with probability F_ij; this holds for both ends (Sbert 1993).
"""

import warnings
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import drjit as dr
import numpy as np

from ...device.turn import turn
from ...errors import MethodError, RadiosityWarning
from ...method.lines import LINES
from ...method.model import Method
from ...sampling.blocks import BITS, BLOCK, Blocks
from ...sampling.global_lines import by_disc, by_two_points, of_bundle
from ...sampling.numbers import ready
from ...sampling.streams import Purpose, Seed
from ...scene.precision import EPSILON
from ..bvh import REACH
from ..geometry import Geometry
from .chords import MARGIN, crossing_box, walk
from .crossing import CODES, ESCAPED, LOST, ONE_WAY, Crossings
from .entrance import Entrance
from .sorting import ordered
from .surfaces import Surfaces

__all__ = ["CODES", "ESCAPED", "LOST", "ONE_WAY", "Pairs", "Spans"]

CHUNK = 1 << 20  # lines of a launch
FEW_ENDS, NO_ENDS = 1e-2, 1e-4  # expected ends of a line: below the first is a warning, below the second an error
LEAST_SIDE, MOST_SIDE = 3, 9  # a bundle's lattice has 2^3 to 2^9 lines along an edge
DENSE = 16  # lines of a bundle for each face: with more, packets pay
ROOM = 1.25  # spans for which a launch makes room, divided by those expected


@dataclass(frozen=True, eq=False)
class Pairs:
    """Spans of some lines.

    Attributes:
        line: (m,) uint32, the line's number within the call, from 0 on, ascending; the spans of a line in order of depth.
        one, other: (m,) uint32 patch numbers; or ESCAPED (nothing there) or LOST (an absorbing back); or, in ``other`` alone,
            ONE_WAY | patch: a patch that ``one`` sees through backs that let lines pass, and that does not see ``one``. Numbers
            below ONE_WAY are patches, and each such number is one end of a span on that patch.
        ends_per_line: (n_patches,) float64, expected ends on each patch per line.
    """

    line: np.ndarray
    one: np.ndarray
    other: np.ndarray
    ends_per_line: np.ndarray


@dataclass(frozen=True, eq=False)
class Spans:
    """A source of spans; every span is a function of (seed, replicate, number of its line).

    Attributes:
        geometry: the scene on a device.
        method: ``lines`` other than local, and ``numbers``.
        seed, replicates: as in a run.
    """

    geometry: Geometry
    method: Method
    seed: Seed | int
    replicates: int

    def __post_init__(self):
        if self.method.lines not in LINES or self.method.lines == "local":
            raise MethodError(f"lines '{self.method.lines}' have no spans; take {', '.join(k for k in LINES if k != 'local')}")
        self._check_filled()

    def _check_filled(self) -> None:
        """Warn where the faces fill next to nothing of the ball that lines go through, and raise where no run would end."""
        ends = float(self.ends_per_line.sum())
        if ends >= FEW_ENDS:
            return
        scene = self.geometry.scene
        corners = scene.vertices[np.where(scene.faces < 0, scene.faces[:, :1], scene.faces)]
        name = scene.names[scene.surface[np.abs(corners - scene.centre).max(axis=(1, 2)).argmax()]]
        text = (
            f"of lines '{self.method.lines}', through the ball about the whole scene, {ends / 2:.2g} meet faces that see each "
            f"other, since '{name}' lies far away; take lines 'spans' or 'local'"
        )
        if ends < NO_ENDS:
            raise MethodError(text)
        warnings.warn(f"{scene.source}: {text}", RadiosityWarning, stacklevel=5)

    @turn()
    def draw(self, replicate: int, first: int, count: int) -> Pairs:
        """Return the spans of the lines ``first`` to below ``first + count`` (from 0) of a replicate.

        Raises:
            MethodError: the sequence of numbers has fewer points.
        """
        parts, start = [], 0
        while start < count:
            width = min(CHUNK, count - start, self._end_of_block(first + start) - first - start)
            line, one, other = self._launch(replicate, first + start, width)
            parts.append((line + np.uint32(start) if start else line, one, other))
            start += width
        if len(parts) != 1:
            none = np.zeros(0, np.uint32)
            parts = [[np.concatenate(column) for column in zip((none, none, none), *parts, strict=True)]]
        line, one, other = parts[0]
        return Pairs(line, one, other, self.ends_per_line)

    @cached_property
    def ends_per_line(self) -> np.ndarray:
        """Expected ends on each patch per line, (n_patches,) float64."""
        area, radius = self.geometry.patches.area, self.radius / self.geometry.bvh.scale
        if self.method.lines == "spans":
            return 2 * area / self.surfaces.area
        return area / (8 * radius**2 if self.method.lines == "bundles" else 2 * np.pi * radius**2)

    @cached_property
    def bundle(self) -> int:
        """Lines of a bundle: a power of four, such that a mean patch has a quarter to one end in a bundle. More would cost
        directions, which errors depend on most."""
        area, radius = self.geometry.patches.area, self.radius / self.geometry.bvh.scale
        wanted = 8 * radius**2 / area.mean()
        return 4 ** int(np.clip(np.floor(np.log2(wanted) / 2), LEAST_SIDE, MOST_SIDE))

    @property
    def coherent(self) -> bool:
        """Lines are traced in packets: those of bundles so dense that packets meet the same faces."""
        return self.method.lines == "bundles" and self.bundle >= DENSE * self.geometry.scene.n_faces

    @cached_property
    def radius(self) -> float:
        """Radius of the ball about the middle of the scene's box, in the BVH's units."""
        distance = np.linalg.norm(self._vertices - self.middle, axis=1).max()
        return float(np.float32(distance * (1 + 8 * EPSILON)))

    @cached_property
    def middle(self) -> np.ndarray:
        """Centre of that ball, (3,)."""
        return self._bounds.mean(axis=0)

    @cached_property
    def crossings(self) -> Crossings:
        return Crossings(self.geometry)

    @cached_property
    def entrance(self) -> Entrance:
        return Entrance(self.crossings, *self._bounds)

    @cached_property
    def surfaces(self) -> Surfaces:
        return Surfaces(self.geometry)

    @cached_property
    def _numbers(self):
        return ready(self.method.points, self.geometry.device.types)

    @cached_property
    def _blocks(self) -> Blocks:
        return Blocks(self._numbers, self.geometry.device.types, self.seed, self.replicates, Purpose.NUMBERS)

    @property
    def _of_a_point(self) -> int:
        """The number of lines that share a point of the sequence."""
        return self.bundle if self.method.lines == "bundles" else 1

    def _block(self, line: int) -> int:
        """Return the block of the point of a line, counted from 0 on; points are counted from 1 on."""
        return (line // self._of_a_point + 1) >> BITS

    def _end_of_block(self, line: int) -> int:
        """Return the first line of the next block."""
        return (((self._block(line) + 1) << BITS) - 1) * self._of_a_point

    def _words(self, block: int):
        """Return the randomisations of the replicates in a block; the last one is kept."""
        if self._last.get("block") != block:
            self._last.update(block=block, words=self._blocks.words(block))
        return self._last["words"]

    @cached_property
    def _last(self) -> dict[str, Any]:
        return {}

    def _launch(self, replicate: int, first: int, count: int):
        """Return the number of the line, one end and the other, of the spans of at most CHUNK lines."""
        types = self.geometry.device.types
        UInt32 = types.UInt32
        each, low, block = self._of_a_point, BLOCK - 1, self._block(first)
        bundle = dr.opaque(UInt32, (first // each + 1) & low)  # the point of the first line, where lines share it
        begin, at = dr.opaque(UInt32, (first + 1 if each == 1 else first % each + 1) & low), dr.opaque(UInt32, 2 * replicate)
        table = self._words(block)
        words = [*dr.gather(types.Array4u, table, at), *dr.gather(types.Array4u, table, at + 1)]
        last = low if block else (first + count - 1) // each + 1
        points = partial(self._numbers.points, patch=UInt32(0), randomisation=words, bits=self._numbers.bits_for(last))
        lane = ordered(types, self.method.lines, self.method.points, begin, count)
        dr.eval(lane)
        if self.method.lines == "spans":
            return self.surfaces.spans(self.crossings, lambda lane: points(begin + lane), lane, count)
        line = partial(self._line, points, begin, bundle)
        box = [types.Array3f(*(dr.opaque(types.Float, float(x)) for x in corner)) for corner in self._box]

        def entering(lane):
            origin, direction = line(lane)
            _, distance, axis = crossing_box(origin, direction, *box)
            outside = origin + direction * (distance - MARGIN)
            if not self.entrance.known:
                return outside, direction, types.Bool(False), UInt32(ESCAPED)
            within, patch, inside = self.entrance.find(origin + direction * distance, direction, axis)
            return dr.select(within, inside, outside), direction, within, patch

        meets = crossing_box(*line(lane), *box)[0] & (lane < dr.opaque(UInt32, count))
        met: Any = dr.compress(meets)
        index = dr.gather(UInt32, lane, met)
        room = int(ROOM * count * self.ends_per_line.sum()) + 1024
        walked = walk(self.crossings, index, max(count, 2), entering, room, coherent=self.coherent)
        return walked.line, walked.one, walked.other

    def _line(self, points, begin, bundle, lane):
        """Return a point and the direction of the line with number ``begin`` + ``lane``, from 1 on: of a block, or of a bundle.

        Args:
            bundle: the point of the bundle in which lane 0 lies.
        """
        types = self.geometry.device.types
        radius = dr.opaque(types.Float, self.radius)
        if self.method.lines == "global":
            point, direction = by_two_points(points(begin + lane), radius, types.Array3f)
        elif self.method.lines == "global-disc":
            point, direction = by_disc(points(begin + lane), radius, types.Array3f)
        else:
            number, bits = begin + lane - 1, self.bundle.bit_length() - 1
            numbers, cell = points((number >> bits) + bundle), number & (self.bundle - 1)
            point, direction = of_bundle(numbers, cell, bits // 2, radius, types.Array3f)
        return point + types.Array3f(*(dr.opaque(types.Float, float(x)) for x in self.middle)), direction

    @cached_property
    def _vertices(self) -> np.ndarray:
        """Vertices that faces use, (n, 3) float64, in the BVH's units."""
        faces = self.geometry.scene.faces
        return self.geometry.bvh.vertices[np.unique(faces[faces >= 0])].astype(np.float64)

    @cached_property
    def _bounds(self) -> np.ndarray:
        """The scene's box in the BVH's units, (2, 3)."""
        return np.stack([self._vertices.min(axis=0), self._vertices.max(axis=0)])

    @property
    def _box(self) -> np.ndarray:
        """The box, a little wider, (2, 3)."""
        return self._bounds + np.array([[-1.0], [1.0]]) * 4 * EPSILON * 2.0**REACH
