"""Form factors from the middles of patches by hemicubes.

M. F. Cohen and D. P. Greenberg, "The hemi-cube: a radiosity solution for complex environments", SIGGRAPH 1985.

Half a cube stands over the patch's centroid. One line goes through the middle of each of its pixels, and its first hit gets the
pixel's form factor. So a row of the matrix costs 3 resolution² lines and needs no other row. There are two errors. Patches are
seen from the centre alone, which is wrong where they are near (by the square of their size over their distance). A patch counts
in whole pixels: small ones get too much or nothing. The errors of cubes turned at random are random; those of other cubes are
alike, see docs/baselines.md.
"""

from dataclasses import dataclass, fields
from functools import lru_cache

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..errors import MethodError
from ..patches.model import Patches
from ..sampling.streams import Purpose, Seed, stream
from ..tracing.geometry import Geometry
from ..tracing.hits import first_hit, patch_of
from ..tracing.lanes import CHUNK
from .model import Factors

MOST = 2048  # pixels along an edge
SUMS = 1 << 24  # sums of rows and columns at a time: 128 MiB


@dataclass(frozen=True)
class Hemicube:
    """The choices by which rows are found.

    Attributes:
        resolution: pixels along the edge of the top face, even; the four sides have half as many rows.
        turned: each cube is turned about the normal by a random angle. Otherwise all cubes stand along the first edge of their
            face, and so their errors are alike.
        seed, replicate: an angle is a function of (seed, replicate, patch).
    """

    resolution: int = 64
    turned: bool = True
    seed: Seed | int = 0
    replicate: int = 0

    def __post_init__(self):
        if self.resolution % 2 or not 2 <= self.resolution <= MOST:
            raise MethodError(f"a hemicube's resolution is {self.resolution}; it must be even, and 2 to {MOST}")

    @property
    def lines(self) -> int:
        """The number of lines of each row."""
        return 3 * self.resolution**2

    def rows(self, geometry: Geometry, numbers: np.ndarray) -> Factors:
        """Return the form factors from some patches to all.

        Args:
            numbers: (k,) int, patches.

        Returns:
            Factors whose ``rows`` are 0 to k - 1, places in ``numbers``. Pairs of row and column are in order, each at most once.
            ``escaped`` and ``lost`` are (k,). Each row sums to one with them, but for rounding.
        """
        numbers = np.asarray(numbers, np.int64)
        size = max(min(CHUNK // self.lines, SUMS // (len(geometry.patches) + 2)), 1)
        parts = [self._some(geometry, numbers[at : at + size], at) for at in range(0, len(numbers), size)]
        if not parts:
            none = np.zeros(0)
            return Factors(none.astype(np.int64), none.astype(np.int64), none, none, none)
        return Factors(*(np.concatenate([getattr(p, field.name) for p in parts]) for field in fields(Factors)))

    def _some(self, geometry: Geometry, numbers: np.ndarray, at: int) -> Factors:
        n, k = len(geometry.patches), len(numbers)
        patches = _patches_hit(geometry, self._frames(geometry, numbers), self.resolution).astype(np.int64)
        cells = (patches.reshape(k, self.lines) + np.arange(k)[:, None] * (n + 2)).ravel()
        sums = np.bincount(cells, weights=np.tile(deltas(self.resolution), k), minlength=k * (n + 2)).reshape(k, n + 2)
        rows, columns = np.nonzero(sums[:, :n])
        return Factors(rows + at, columns, sums[rows, columns], sums[:, n], sums[:, n + 1])

    def _frames(self, geometry: Geometry, numbers: np.ndarray) -> np.ndarray:
        """Return the lines' origin, two tangents and the normal, (k, 12), in the BVH's coordinates."""
        patches, bvh = geometry.patches, geometry.bvh
        face, normal = patches.face[numbers], patches.normal[numbers]
        first = patches.scene.frames[1][face]
        tangent = first / np.linalg.norm(first, axis=1, keepdims=True)
        across = np.cross(normal, tangent)
        angle = self._angles(patches)[numbers] if self.turned else np.zeros(len(numbers))
        cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
        origin = (patches.centroid[numbers] - bvh.centre) * bvh.scale
        origin += normal * geometry.faces.offset(face, origin)[:, None]
        return np.concatenate([origin, cosine * tangent + sine * across, cosine * across - sine * tangent, normal], axis=1)

    def _angles(self, patches: Patches) -> np.ndarray:
        generator = np.random.Generator(np.random.Philox(stream(self.seed, self.replicate, Purpose.HEMICUBE)))
        return 2 * np.pi * generator.random(len(patches))


def _patches_hit(geometry: Geometry, frames: np.ndarray, resolution: int) -> np.ndarray:
    """Return the patch that each line hits, (k * 3 resolution²,) uint32; n and n + 1 are escaped and lost."""
    types, n = geometry.device.types, len(geometry.patches)
    words, ways = upload(types.Float, frames.astype(np.float32)), upload(types.Float, directions(resolution).astype(np.float32))
    pixels = dr.opaque(types.UInt32, 3 * resolution**2)
    lane = dr.arange(types.UInt32, len(frames) * 3 * resolution**2)
    row = lane // pixels
    x, y, z = dr.gather(types.Array3f, ways, lane - row * pixels)
    origin, tangent, across, normal = (
        types.Array3f(*(dr.gather(types.Float, words, row * 12 + at + i) for i in range(3))) for at in range(0, 12, 3)
    )
    hit = first_hit(geometry, origin, tangent * x + across * y + normal * z)
    patches = patch_of(geometry, hit, n + 1, n)
    dr.eval(patches)
    return np.array(patches)


@lru_cache(2)
def directions(resolution: int) -> np.ndarray:
    """Return unit vectors through the pixels' middles, z along the normal, (3 resolution², 3).

    The top face comes first, then the sides +x, +y, -x, -y, each row by row.
    """
    edges = np.linspace(-1, 1, resolution + 1)
    middle = (edges[1:] + edges[:-1]) / 2
    y, x = (a.ravel() for a in np.meshgrid(middle, middle, indexing="ij"))
    z, along = (a.ravel() for a in np.meshgrid(middle[resolution // 2 :], middle, indexing="ij"))
    one = np.ones_like(z)
    sides = [(one, along, z), (-along, one, z), (-one, -along, z), (along, -one, z)]
    ways = np.concatenate([np.column_stack(face) for face in ((x, y, np.ones_like(x)), *sides)])
    return ways / np.linalg.norm(ways, axis=1, keepdims=True)


@lru_cache(2)
def deltas(resolution: int) -> np.ndarray:
    """Return the pixels' exact form factors, (3 resolution²,).

    They are differences of those of rectangles, from the point under the corner of a parallel one and at the foot of a
    perpendicular one (Howell B-4, B-5). They sum to one; the kernel at pixels' middles times their areas does not.
    """
    edges = np.linspace(-1, 1, resolution + 1)
    root = np.sqrt(1 + edges**2)
    arc = edges / root * np.arctan(edges[:, None] / root)  # along columns, at the corner of each row
    top = np.diff(np.diff(arc + arc.T, axis=0), axis=1) / (2 * np.pi)
    up, height = root[resolution // 2 :, None], edges
    foot = np.arctan(height) - np.arctan(height / up) / up
    side = np.diff(np.diff(foot, axis=0), axis=1) / (2 * np.pi)
    return np.concatenate([top.ravel(), *[side.ravel()] * 4])
