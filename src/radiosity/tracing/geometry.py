"""The records of a scene that kernels read: they lead from a patch to a line, and from a hit to a patch.

A patch is found from a hit by arithmetic, so that finer patches neither grow the BVH nor slow a line.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..device.backend import Device, upload
from ..patches import cells
from ..patches.model import Patches
from ..pieces import pieces
from ..scene.model import Back, Scene
from .bvh import Bvh, primitives
from .faces import COLUMN_BITS, INVERTED, NORMAL_BITS, NORMAL_ONE, OFFSET, QUAD, SECOND_HALF, Faces
from .panes import Panes
from .ties import Ties

INSET = 4 * OFFSET  # of a face's largest coordinate: so far from its edges lines begin, and the offset leads through no neighbour

# Counts the changes of where lines begin and what they meet: runs begun under another number have other bits, and do not go on.
TRACING = 2

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

    @cached_property
    def faces(self) -> Faces:
        return Faces(self.patches, self.device)

    @property
    def bvh(self) -> Bvh:
        return self.faces.bvh

    @cached_property
    def made(self) -> dict:
        """Values that algorithms have made of the scene and may use again, by what they follow from."""
        return {}

    def prepare(self) -> None:
        """Make what kernels read, before any loop is recorded (`recorded.not_recorded`)."""
        self.prepare_hits()
        _ = self.face_records, self.patch_records

    def prepare_hits(self) -> None:
        """Make the part of it that hits are read from."""
        _ = self.bvh, self.hit_records, self.faces.primitive_faces, self.faces.offsets
        if self.ties is not None:
            self.ties.prepare()
        if self.panes is not None:
            _ = self.panes.thresholds, self.panes.angles

    @cached_property
    def ties(self) -> Ties | None:
        """Faces in one plane, where there are any."""
        ties = Ties(self.faces)
        return ties if len(ties.standing) else None

    @cached_property
    def panes(self) -> Panes | None:
        """Faces that let a share of lines through from both sides, where there are any."""
        return Panes(self.scene, self.device) if self.scene.panes.any() else None

    @cached_property
    def some_backs_pass(self) -> bool:
        """True where lines go on through some faces, from behind or from both sides."""
        return bool(np.isin(self.scene.back, (Back.PASSES, Back.OPEN)).any())

    @cached_property
    def some_backs_radiate(self) -> bool:
        return bool((self.scene.back == Back.RADIATES).any())

    @cached_property
    def all_quads(self) -> bool:
        return bool(self.scene.is_quad.all())

    @cached_property
    def whole_faces(self) -> bool:
        """True where no face is cut, so that a hit's coordinates are not needed."""
        return bool((self.patches.columns == 1).all() and (self.patches.rows == 1).all())

    @cached_property
    def starts(self) -> np.ndarray:
        """The part of faces where lines begin, drawn in from the edges: low ends and sizes along both, (4, n_faces), shares."""
        scene = self.scene
        _, first, second = self.faces.frames
        area = np.linalg.norm(np.cross(first, second), axis=1)
        lengths = [np.linalg.norm(edge, axis=1) for edge in (first, second, second - first)]
        inset = self.faces.offset(np.arange(scene.n_faces), self.faces.corners) * (INSET / OFFSET)
        # a triangle is drawn in by a share about its centroid, a parallelogram by a margin on each side
        share = np.minimum(3 * inset * np.max(lengths, axis=0) / area, 0.75)
        margins = [np.minimum(inset * lengths[1 - i] / area, 0.375) for i in (0, 1)]
        low = (np.where(scene.is_quad, m, share / 3) for m in margins)
        return np.array([*low, *(np.where(scene.is_quad, 1 - 2 * m, 1 - share) for m in margins)])

    @property
    def left_out(self) -> np.ndarray:
        """The share of each face's area along its edges where no line begins, (n_faces,)."""
        return 1 - self.starts[2] * self.starts[3]

    @cached_property
    def face_records(self):
        """Origin, edges of a cell, normal, tangent and least offset of faces drawn in from their edges, (n_faces * 16,) Float."""
        origin, first, second = self.faces.frames
        low_u, low_v, size_u, size_v = self.starts
        drawn = origin + low_u[:, None] * first + low_v[:, None] * second
        cell_first = first * (size_u / self.patches.columns)[:, None]
        cell_second = second * (size_v / self.patches.rows)[:, None]
        tangent = first / np.linalg.norm(first, axis=1)[:, None]
        record = np.concatenate(
            [drawn, cell_first, cell_second, self.faces.normals, tangent, self.faces.plane_offsets[:, None]], axis=1
        )
        return upload(self.device.types.Float, record.astype(np.float32))

    @cached_property
    def hit_records(self):
        """First patch of the front, cell counts and flags, and the normal in two words, (n * 4,) UInt32.

        There is one record for each of n primitives; where all faces are quads, one for each of n faces.
        """
        _, face = primitives(self.scene)
        if self.all_quads:
            face = face[::2]
        x, y, z = (self.faces.steps[face] + NORMAL_ONE + 1).T
        record = np.zeros((len(face), HIT_WORDS), np.uint32)
        record[:, 0], record[:, 1] = self.patches.first[:-1][face], self.faces.packed[face]
        record[np.concatenate([[False], face[1:] == face[:-1]]), 1] |= SECOND_HALF
        both = x | y << NORMAL_BITS | z << 2 * NORMAL_BITS
        record[:, 2], record[:, 3] = both & 0xFFFFFFFF, both >> 32
        if self.ties is not None:
            record[self.ties.flagged[face], 3] |= TIED
        return upload(self.device.types.UInt32, record)

    @cached_property
    def patch_records(self):
        """Face (top bit: its back), and column, row and flags of the cell of each patch, (n_patches * 2,) UInt32."""
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
