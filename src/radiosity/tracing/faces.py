"""The faces of a scene in the BVH's coordinates."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..device.backend import Device, upload
from ..patches.model import Patches
from ..scene.model import Scene, unit_normals
from ..scene.precision import OFFSET, plane_reach
from .bvh import Bvh, bvh, primitives

NEAR = 1.0  # of 2^20 that the scene reaches to: smaller numbers count as this, or lines would stay where all are zero

COLUMN_BITS = 14
QUAD, SECOND_HALF, INVERTED = 1 << 28, 1 << 29, 1 << 30
BACK_BIT = 30  # of a hit record's flags: two bits, a `Back`
NORMAL_BITS = 21  # of each component of a normal in a hit record: it only tells the side that a line comes from
NORMAL_ONE = (1 << NORMAL_BITS - 1) - 1


@dataclass(frozen=True, eq=False)
class Faces:
    """Faces, cut into the cells of patches, and the BVH over them."""

    patches: Patches
    device: Device

    @property
    def scene(self) -> Scene:
        return self.patches.scene

    @cached_property
    def bvh(self) -> Bvh:
        return bvh(self.scene, self.device)

    @cached_property
    def frames(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Origin and edges of the faces, (n_faces, 3) float64 each, computed from the BVH's vertices."""
        scene, vertices = self.scene, self.bvh.vertices.astype(np.float64)
        origin = vertices[scene.faces[:, 0]]
        first = vertices[scene.faces[:, 1]] - origin
        second = vertices[np.where(scene.is_quad, scene.faces[:, 3], scene.faces[:, 2])] - origin
        return origin, first, second

    @cached_property
    def normals(self) -> np.ndarray:
        """Unit normals, (n_faces, 3) float64, computed from the BVH's vertices."""
        _, first, second = self.frames
        return unit_normals(first, second)

    @cached_property
    def corners(self) -> np.ndarray:
        """Corners, (n_faces, 4, 3) float64, in the BVH's coordinates; a triangle repeats its last corner."""
        origin, first, second = self.frames
        fourth = origin + first + second * self.scene.is_quad[:, None]
        return np.stack([origin, origin + first, origin + second, fourth], axis=1)

    @cached_property
    def plane_offsets(self) -> np.ndarray:
        """Least distances by which lines begin in front of each face, from what its plane is rounded by.

        (n_faces,) float64, in the BVH's units.
        """
        return OFFSET * np.maximum(plane_reach(self.normals, self.corners), NEAR)

    def offset(self, face: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Return how far in front of faces lines begin, (m,) float64, in the BVH's units.

        Args:
            face: (m,) int. points: (m, ..., 3) in the BVH's coordinates. Where a face has several points, the largest offset is
                taken.
        """
        reach = np.abs(points).reshape(len(points), -1).max(axis=1)
        return np.maximum(OFFSET * reach, self.plane_offsets[face])

    @cached_property
    def steps(self) -> np.ndarray:
        """Normals in units of hit records, (n_faces, 3) int64."""
        return np.round(self.normals * NORMAL_ONE).astype(np.int64)

    @cached_property
    def packed(self) -> np.ndarray:
        """Cell counts and flags of hit records, (n_faces,) int64."""
        packed = self.patches.columns | (self.patches.rows.astype(np.int64) << COLUMN_BITS)
        return packed | np.where(self.scene.is_quad, QUAD, 0) | self.scene.back.astype(np.int64) << BACK_BIT

    @property
    def first_primitives(self) -> np.ndarray:
        """The first triangle of each face, (n_faces,) int64."""
        many = 1 + self.scene.is_quad.astype(np.int64)
        return np.cumsum(many) - many

    @cached_property
    def primitive_faces(self):
        """The face of each of the BVH's triangles, (n_primitives,) UInt32."""
        return upload(self.device.types.UInt32, primitives(self.scene)[1].astype(np.uint32))

    @cached_property
    def offsets(self):
        """`plane_offsets` on the device, (n_faces,) Float."""
        return upload(self.device.types.Float, self.plane_offsets.astype(np.float32))
