"""The faces that two scenes have in common, cut or not."""

from dataclasses import dataclass

import numpy as np

from ..patches.model import Patches
from ..scene.model import Scene
from .overlap import Cells

SAME = 1e-6  # relative: areas, and directions of normals


@dataclass(frozen=True, eq=False)
class WholeFaces:
    """The whole faces that the faces of a scene are parts of (`Scene.cut`); the faces themselves where none is cut.

    Attributes:
        scene: the scene.
        of: (n_faces,) int64, the whole face of each face.
        largest: (n_whole,) int64, the largest part of each whole face.
        area: (n_whole,) m².
    """

    scene: Scene
    of: np.ndarray
    largest: np.ndarray
    area: np.ndarray

    @staticmethod
    def among(scene: Scene) -> "WholeFaces":
        """Return those of a scene."""
        of = np.arange(scene.n_faces) if scene.cut is None else scene.cut.face
        area = np.bincount(of, scene.area)
        order = np.lexsort((-scene.area, of))
        largest = np.full(len(area), -1)
        numbers, first = np.unique(of[order], return_index=True)
        largest[numbers] = order[first]
        return WholeFaces(scene, of, largest, area)

    def like(self, other: "WholeFaces") -> bool:
        """Return whether whole faces of the same number have the same area, normal, surface, backs and panes."""
        if len(self.area) != len(other.area) or min(self.largest.min(), other.largest.min()) < 0:
            return False
        if (np.abs(self.area - other.area) > SAME * other.area).any():
            return False
        if (np.abs(self.scene.normal[self.largest] - other.scene.normal[other.largest]) > SAME).any():
            return False
        for name in ("back", "surface", "transmittance", "refractive_index"):
            values = [getattr(one.scene, name) for one in (self, other)]
            taken = [None if value is None else value[one.largest] for value, one in zip(values, (self, other), strict=True)]
            if (taken[0] is None) != (taken[1] is None) or (taken[0] is not None and (taken[0] != taken[1]).any()):
                return False
        return True

    @property
    def planes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """An origin and two perpendicular unit vectors in the plane of each whole face, (n_whole, 3) each."""
        origin, first, _ = (frame[self.largest] for frame in self.scene.frames)
        axis = first / np.linalg.norm(first, axis=1)[:, None]
        return origin, axis, np.cross(self.scene.normal[self.largest], axis)

    def cells(self, patches: Patches, planes: tuple[np.ndarray, np.ndarray, np.ndarray]) -> tuple[Cells, np.ndarray]:
        """Return the cells of patches in the planes of whole faces, and how far they lie off them, (n,) metres.

        Cells are the fronts of the patches, in their order.
        """
        fronts = ~patches.is_back
        face = self.of[patches.face[fronts]]
        origin, axis, across = (vectors[face][:, None] for vectors in planes)
        offset = patches.corners[fronts] - origin
        height = np.abs((offset * np.cross(axis, across)).sum(axis=2)).max(axis=1)
        polygons = np.stack([(offset * axis).sum(axis=2), (offset * across).sum(axis=2)], axis=2)
        return Cells(polygons, face), height
