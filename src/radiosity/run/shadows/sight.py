"""What stands between points of a scene and places of lights."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...device.backend import choose
from ...patches import subdivide
from ...scene.model import Scene
from ...scene.precision import ulp
from ...tracing.first_hits import hits_of
from ...tracing.geometry import Geometry

ULPS = 16  # lines begin so far in front of a face
AT_LIGHT = 1e-4  # of the way: what is hit so near to a light's place belongs to the light


@dataclass(frozen=True, eq=False)
class Sight:
    """A scene without its clear panes, on a device.

    Attributes:
        faces: (m,) int64, the faces of the scene that are not left out.
    """

    scene: Scene
    geometry: Any
    faces: np.ndarray

    @staticmethod
    def of(scene: Scene, device: str = "auto") -> "Sight":
        """Return that of a scene.

        Raises:
            DeviceError: there is no usable back end.
        """
        faces = np.flatnonzero(~scene.panes)
        solid = scene.take(faces) if len(faces) < scene.n_faces else scene
        return Sight(scene, Geometry(subdivide(solid, cells=1), choose(device)), faces)

    def met(self, points: np.ndarray, normals: np.ndarray, face: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Return the face that stands between each point and a light, (m,) int64; -1 where the point sees the light.

        Args:
            points, normals: (m, 3) on faces, and unit normals of the sides. face: (m,) their numbers.
            place: (m, 4) of lights, or (4,).
        """
        reach = self.scene.plane_reach[face]
        start = points + ULPS * ulp(points, self.scene.centre, reach)[:, None] * normals
        way = place[..., :3] - place[..., 3:] * start
        length = np.where(place[..., 3] > 0, np.linalg.norm(way, axis=1), np.inf)
        hits = hits_of(self.geometry, start, way)
        before = (hits.face >= 0) & (hits.distance < length * (1 - AT_LIGHT))
        return np.where(before, self.faces[hits.face], -1)
