"""The triangles of the radiating sides of a scene, which a lightmap gives places to."""

from dataclasses import dataclass

import numpy as np

from ..scene.model import Back, Scene

# face coordinates of the corners of triangles, counterclockwise seen from the front
TRIANGLE = np.array([[0, 0], [1, 0], [0, 1]], float)
HALVES = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], float)


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles of sides, in the order of surfaces, of sides within them (fronts first, dim ones last), and of faces.

    Attributes:
        scene: that they are of.
        face: (m,) int64, the face of each.
        back: (m,) bool, its side.
        place: (m, 3, 2) float64, face coordinates of the corners, counterclockwise seen from the side.
        sheet: (m,) int64, number of the surface, side, and whether it is dim, without gaps.
        dark: (m,) bool, no light comes to that side of the face.
    """

    scene: Scene
    face: np.ndarray
    back: np.ndarray
    place: np.ndarray
    sheet: np.ndarray
    dark: np.ndarray

    def __len__(self) -> int:
        return len(self.face)

    @staticmethod
    def of(scene: Scene, dark: np.ndarray | None = None, dim: np.ndarray | None = None) -> "Triangles":
        """Return those of a scene: of all fronts, and of backs that radiate.

        Args:
            dark: (n_faces, 2) bool, fronts and backs that no light comes to. Where that is all of them, none counts as dark.
            dim: (n_faces, 2) bool, fronts and backs that are sheets of their own.
        """
        quads, flat = np.flatnonzero(scene.is_quad), np.flatnonzero(~scene.is_quad)
        face = np.concatenate([flat, np.repeat(quads, 2)])
        corners = [np.broadcast_to(TRIANGLE, (len(flat), 3, 2)), np.tile(HALVES, (len(quads), 1, 1))]
        place = np.concatenate(corners)
        two = scene.back[face] == Back.RADIATES
        back = np.repeat([False, True], [len(face), int(two.sum())])
        face, place = np.concatenate([face, face[two]]), np.concatenate([place, place[two][:, [0, 2, 1]]])
        key = 2 * (2 * scene.surface[face].astype(np.int64) + back)
        key += 0 if dim is None else dim[face, back.astype(int)]
        order = np.lexsort((face, key))  # stable: halves of a face keep their order
        sheet = np.unique(key[order], return_inverse=True)[1].ravel()
        face, back, place = face[order], back[order], place[order]
        black = np.zeros(len(face), bool) if dark is None else dark[face, back.astype(int)]
        return Triangles(scene, face, back, place, sheet, black & ~black.all())

    def corners(self) -> np.ndarray:
        """Return the numbers of the scene's vertices at the corners, (m, 3); of parallelograms as of their faces."""
        faces, (u, v) = self.scene.faces[self.face], (self.place[..., 0] > 0.5, self.place[..., 1] > 0.5)
        last = np.where(self.scene.is_quad[self.face], 3, 2)[:, None]
        return np.take_along_axis(faces, np.where(u & v, 2, np.where(v, last, np.where(u, 1, 0))), axis=1)
