"""The display mesh of patches: polygons with shared vertices, and patch values smoothed to those vertices."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..patches import Patches, cells
from .sheets import CHUNK, Sheets


@dataclass(frozen=True, eq=False)
class DisplayMesh:
    """One polygon for each patch, in the patches' order; vertices shared within a surface and side, except across creases.

    Attributes:
        vertices: (n_vertices, 3) float64, metres.
        polygons: (n_patches, 4) int32, counterclockwise seen from the patch's side; a triangle repeats its third vertex.
        angle: (n_patches, 4) float32, the polygon's angle at each vertex, radians; 0 where a triangle repeats one.
        surface: (n_patches,) int32 index into the scene's names.
    """

    vertices: np.ndarray
    polygons: np.ndarray
    angle: np.ndarray
    surface: np.ndarray

    @cached_property
    def is_quad(self) -> np.ndarray:
        """Which polygons are quadrilaterals, (n_patches,) bool."""
        return self.polygons[:, 2] != self.polygons[:, 3]

    def smoothed(self, values: np.ndarray) -> np.ndarray:
        """Turn patch values (n_patches, n_bands) into vertex values (n_vertices, n_bands).

        They are means of the patches around a vertex, weighted by their angles there. Unknown (NaN) patches are left out; a mean
        is NaN where all are unknown.
        """
        values = np.asarray(values, np.float64)
        return self.smoothed_corners(values[:, None])

    def smoothed_corners(self, values: np.ndarray) -> np.ndarray:
        """Turn values at the corners of patches, (n_patches, 4 or 1, n_bands), into vertex values, see `smoothed`."""
        corner, n = self.polygons.ravel(), len(self.vertices)
        result = np.empty((n, values.shape[2]))
        for band in range(values.shape[2]):
            known = np.isfinite(values[..., band])
            weight = np.where(known, self.angle, 0.0)
            total = np.bincount(corner, (weight * np.where(known, values[..., band], 0.0)).ravel(), n)
            weights = np.bincount(corner, weight.ravel(), n)
            result[:, band] = np.divide(total, weights, out=np.full(n, np.nan), where=weights > 0)
        return result

    @property
    def own_corners(self) -> np.ndarray:
        """Which corners of polygons are vertices of their own in the mesh that `flat` returns, (n_patches, 4) bool."""
        used = np.ones(self.polygons.shape, bool)
        used[:, 3] = self.is_quad
        return used

    def flat(self) -> tuple["DisplayMesh", np.ndarray]:
        """Return the mesh with no vertex shared between patches, and the patch of each of its vertices."""
        used = self.own_corners
        number = (np.cumsum(used.ravel()) - 1).astype(np.int32).reshape(used.shape)
        mesh = DisplayMesh(self.vertices[self.polygons[used]], number, self.angle, self.surface)
        return mesh, np.repeat(np.arange(len(used), dtype=np.int32), used.sum(axis=1))

    def triangles(self) -> tuple[np.ndarray, np.ndarray]:
        """Return triangles, (m, 3) int32 vertex numbers, quadrilaterals cut in two, and the patch of each, (m,) int32."""
        both = np.stack([self.polygons[:, :3], self.polygons[:, [0, 2, 3]]], axis=1)
        keep = np.stack([np.ones(len(both), bool), self.is_quad], axis=1)
        return both[keep], np.broadcast_to(np.arange(len(both), dtype=np.int32)[:, None], keep.shape)[keep]


def build(patches: Patches) -> DisplayMesh:
    """Return the display mesh of patches. Vertices inside a face are found by arithmetic; only those on its rim are compared."""
    scene, n = patches.scene, len(patches)
    sheets = Sheets(patches)
    polygons, angle = np.empty((n, 4), np.int32), np.empty((n, 4), np.float32)
    column, row, inverted = patches.place
    angles = _angles(scene)  # inverted cells have the same ones: they are upright cells turned by half a circle
    for begin in range(0, n, CHUNK):
        part = slice(begin, begin + CHUNK)
        face, back = patches.face[part], patches.is_back[part]
        quad, one = scene.is_quad[face], np.ones(len(face))
        corner = np.rint(cells.corners(column[part], row[part], inverted[part], one, one, quad)).astype(np.int64)
        number = sheets.number(face, back, corner)
        flip = np.where(quad[:, None], [0, 3, 2, 1], [0, 2, 1, 1])
        turn = np.where(back[:, None], flip, np.where(quad[:, None], [0, 1, 2, 3], [0, 1, 2, 2]))
        polygons[part] = np.take_along_axis(number, turn, axis=1)
        angle[part] = np.take_along_axis(angles[face], turn, axis=1) * np.where(quad[:, None], 1, [1, 1, 1, 0])
    vertices, renumber = sheets.welded()
    return DisplayMesh(vertices, renumber[polygons], angle, patches.surface.astype(np.int32))


def _angles(scene) -> np.ndarray:
    """Return the angles of faces at their corners, (n_faces, 4); the fourth of a triangle has no meaning."""
    _, first, second = scene.frames
    a = _angle(first, second)
    b = np.where(scene.is_quad, np.pi - a, _angle(-first, second - first))
    c = np.where(scene.is_quad, a, np.pi - a - b)
    return np.stack([a, b, c, b], axis=1)


def _angle(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.arctan2(np.linalg.norm(np.cross(first, second), axis=1), np.einsum("ij,ij->i", first, second))
