"""The scene as kernels see it: records to go from a patch to a line, and from a hit to a patch.

A patch is found from a hit by arithmetic, so that finer patches neither grow the tree nor slow a line.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..device.backend import Device, upload
from ..patches import cells
from ..patches.model import Patches
from ..pieces import pieces
from ..scene.model import Back, Scene, unit_normals
from ..scene.precision import EPSILON, plane_reach
from .bvh import Bvh, bvh, primitives
from .ties import Ties

OFFSET = 8 * EPSILON  # of the largest number that places a point or its plane: lines begin this far in front of it
NEAR = 1.0  # of 2^20 that the scene reaches to: smaller numbers count as this, or lines would stay where all are zero
INSET = 4 * OFFSET  # of a face's largest coordinate: and this far from its edges, so that the offset leads through no neighbour

# Counts the changes of where lines begin and what they meet: runs begun under another number have other bits, and do not go on.
TRACING = 2

COLUMN_BITS = 14
QUAD, SECOND_HALF, INVERTED = 1 << 28, 1 << 29, 1 << 30
BACK_BIT = 30  # of a hit record's flags: two bits, a `Back`
NORMAL_BITS = 21  # of each component of a normal in a hit record: only the side that a line comes from is asked of it
NORMAL_ONE = (1 << NORMAL_BITS - 1) - 1
HIT_WORDS = 4
TIED = 1 << 31  # of a hit record's last word, which normals leave free: the face shares its plane with others


@dataclass(frozen=True, eq=False)
class Geometry:
    """Patches of a scene on a device."""

    patches: Patches
    device: Device

    @property
    def scene(self) -> Scene:
        return self.patches.scene

    def prepare(self) -> None:
        """Make what kernels read, before any loop is recorded (`recorded.not_recorded`)."""
        self.prepare_hits()
        _ = self.face_records, self.patch_records

    def prepare_hits(self) -> None:
        """Of that, what hits are read from."""
        _ = self.bvh, self.hit_records, self.primitive_faces, self.offsets
        if self.ties is not None:
            self.ties.prepare()

    @cached_property
    def bvh(self) -> Bvh:
        return bvh(self.scene, self.device)

    @cached_property
    def ties(self) -> Ties | None:
        """Faces in one plane, where there are any."""
        ties = Ties(self)
        return ties if len(ties.standing) else None

    @cached_property
    def some_backs_pass(self) -> bool:
        """Lines go on through some faces, from behind or from both sides."""
        return bool(np.isin(self.scene.back, (Back.PASSES, Back.OPEN)).any())

    @cached_property
    def some_backs_radiate(self) -> bool:
        return bool((self.scene.back == Back.RADIATES).any())

    @cached_property
    def all_quads(self) -> bool:
        return bool(self.scene.is_quad.all())

    @cached_property
    def whole_faces(self) -> bool:
        """No face is cut: a hit's coordinates are not asked for."""
        return bool((self.patches.columns == 1).all() and (self.patches.rows == 1).all())

    @cached_property
    def frames(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Origin and edges of the faces in the caster's coordinates, float64 from its own vertices."""
        scene, vertices = self.scene, self.bvh.vertices.astype(np.float64)
        origin = vertices[scene.faces[:, 0]]
        first = vertices[scene.faces[:, 1]] - origin
        second = vertices[np.where(scene.is_quad, scene.faces[:, 3], scene.faces[:, 2])] - origin
        return origin, first, second

    @cached_property
    def normals(self) -> np.ndarray:
        """(n_faces, 3) float64, of the caster's vertices."""
        _, first, second = self.frames
        return unit_normals(first, second)

    @cached_property
    def corners(self) -> np.ndarray:
        """(n_faces, 4, 3) in the caster's coordinates."""
        origin, first, second = self.frames
        fourth = origin + first + second * self.scene.is_quad[:, None]
        return np.stack([origin, origin + first, origin + second, fourth], axis=1)

    @cached_property
    def plane_offsets(self) -> np.ndarray:
        """(n_faces,) float64, the caster's units: the least by which lines begin in front of a face, from what its plane is
        rounded by."""
        return OFFSET * np.maximum(plane_reach(self.normals, self.corners), NEAR)

    def offset(self, face: np.ndarray, points: np.ndarray) -> np.ndarray:
        """(m,) float64, the caster's units: how far in front of faces lines begin.

        Args:
            face: (m,) int. points: (m, ..., 3) in the caster's coordinates; of several points for a face the largest offset.
        """
        reach = np.abs(points).reshape(len(points), -1).max(axis=1)
        return np.maximum(OFFSET * reach, self.plane_offsets[face])

    @cached_property
    def face_records(self):
        """(n_faces * 16,) Float: origin, edges of a cell, normal, tangent and least offset; the face drawn in from its edges."""
        scene = self.scene
        origin, first, second = self.frames
        area = np.linalg.norm(np.cross(first, second), axis=1)
        lengths = [np.linalg.norm(edge, axis=1) for edge in (first, second, second - first)]
        inset = self.offset(np.arange(scene.n_faces), self.corners) * (INSET / OFFSET)
        # of a triangle the same share about the centroid, of a parallelogram a margin on each side
        share = np.minimum(3 * inset * np.max(lengths, axis=0) / area, 0.75)
        margins = [np.minimum(inset * lengths[1 - i] / area, 0.375) for i in (0, 1)]
        low_u, low_v = (np.where(scene.is_quad, m, share / 3) for m in margins)
        size_u, size_v = (np.where(scene.is_quad, 1 - 2 * m, 1 - share) for m in margins)
        drawn = origin + low_u[:, None] * first + low_v[:, None] * second
        cell_first = first * (size_u / self.patches.columns)[:, None]
        cell_second = second * (size_v / self.patches.rows)[:, None]
        tangent = first / lengths[0][:, None]
        record = np.concatenate([drawn, cell_first, cell_second, self.normals, tangent, self.plane_offsets[:, None]], axis=1)
        return upload(self.device.types.Float, record.astype(np.float32))

    @cached_property
    def hit_records(self):
        """(n * 4,) UInt32: the front's first patch, cell counts and flags, and the normal in two words; of n primitives, or of n
        faces where all are quads, which have two each."""
        _, face = primitives(self.scene)
        if self.all_quads:
            face = face[::2]
        x, y, z = (self.steps[face] + NORMAL_ONE + 1).T
        record = np.zeros((len(face), HIT_WORDS), np.uint32)
        record[:, 0], record[:, 1] = self.patches.first[:-1][face], self.packed[face]
        record[np.concatenate([[False], face[1:] == face[:-1]]), 1] |= SECOND_HALF
        both = x | y << NORMAL_BITS | z << 2 * NORMAL_BITS
        record[:, 2], record[:, 3] = both & 0xFFFFFFFF, both >> 32
        if self.ties is not None:
            record[self.ties.flagged[face], 3] |= TIED
        return upload(self.device.types.UInt32, record)

    @cached_property
    def steps(self) -> np.ndarray:
        """(n_faces, 3) int64: normals in units of hit records."""
        return np.round(self.normals * NORMAL_ONE).astype(np.int64)

    @cached_property
    def packed(self) -> np.ndarray:
        """(n_faces,) int64: cell counts and flags of hit records."""
        packed = self.patches.columns | (self.patches.rows.astype(np.int64) << COLUMN_BITS)
        return packed | np.where(self.scene.is_quad, QUAD, 0) | self.scene.back.astype(np.int64) << BACK_BIT

    @property
    def first_primitives(self) -> np.ndarray:
        """(n_faces,) int64: the first of each face's triangles."""
        many = 1 + self.scene.is_quad.astype(np.int64)
        return np.cumsum(many) - many

    @cached_property
    def primitive_faces(self):
        """(n_primitives,) UInt32: the face of each of the caster's triangles."""
        return upload(self.device.types.UInt32, primitives(self.scene)[1].astype(np.uint32))

    @cached_property
    def offsets(self):
        """(n_faces,) Float: `plane_offsets`."""
        return upload(self.device.types.Float, self.plane_offsets.astype(np.float32))

    @cached_property
    def patch_records(self):
        """(n_patches * 2,) UInt32: face (top bit: its back), and column, row and flags of the cell."""
        patches = self.patches
        record = np.empty((len(patches), 2), np.uint32)
        for part in pieces(len(patches)):
            face = patches.face[part]
            column, row, inverted = patches.places(part)
            flags = np.where(inverted, INVERTED, 0) | np.where(self.scene.is_quad[face], QUAD, 0)
            record[part, 0] = face + np.where(patches.is_back[part], 1 << 31, 0)
            record[part, 1] = column | (row << COLUMN_BITS) | flags
        return upload(self.device.types.UInt32, record)


assert cells.MOST < 1 << COLUMN_BITS
