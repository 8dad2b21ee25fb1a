"""The strongest lights of a scene, as points from which their light comes: sides of faces that emit, luminaires, and suns.

A place is (x, y, z, 1), in metres, or (x, y, z, 0): a direction towards a light that is as far away as the sun. From a point p,
the way to it is (x, y, z) - w p in both cases.
"""

from dataclasses import dataclass

import numpy as np

from ...scene.lights.luminaire import Luminaire
from ...scene.model import Back, Scene

MOST = 64  # lights, by power
POINTS = 16  # of a light that has a size, about
PART = 1 << 13  # points for which a web is read at a time


@dataclass(frozen=True, eq=False)
class Light:
    """A light that casts shadows.

    Attributes:
        middle: (4,) the place of its middle.
        points: (k, 4) places from which equal parts of its light come.
        strength: W or lm, mean of bands: its power, or the irradiance from far away.
        normal: (3,) of a side that emits; zeros for others.
        luminaire: whose web says how light is shared among directions; None for others.
        face: the face that emits; -1 for others.
    """

    middle: np.ndarray
    points: np.ndarray
    strength: float
    normal: np.ndarray
    luminaire: Luminaire | None = None
    face: int = -1

    def irradiance(self, points: np.ndarray, normals: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Return the irradiance of points if all light came from one place and met nothing, (m,).

        Args:
            points, normals: (m, 3). place: (4,), or (m, 4).
        """
        way = place[..., :3] - place[..., 3:] * points
        square = np.maximum((way**2).sum(axis=1), 1e-300)
        cosine = np.maximum((way * normals).sum(axis=1), 0.0) / np.sqrt(square)
        if self.luminaire is not None:
            lamp = self.luminaire
            x, y, z = lamp.axes @ -way.T
            angles = np.degrees([np.arctan2(y, x), np.arctan2(np.hypot(x, y), z)])
            web = np.concatenate([lamp.web.at(*angles[:, at : at + PART]) for at in range(0, len(square), PART)] or [square])
            return self.strength * web / lamp.web.flux * cosine / square
        if self.face < 0:
            return self.strength * cosine
        leaving = np.maximum(-(way @ self.normal), 0.0) / np.sqrt(square)
        return self.strength / np.pi * leaving * cosine / square


def strongest(scene: Scene) -> list[Light]:
    """Return the strongest lights of a scene: suns, then luminaires and sides that emit, by power."""
    power = np.concatenate([scene.emission.mean(axis=1), scene.back_emission.mean(axis=1) * (scene.back == Back.RADIATES)])
    power = power * np.tile(scene.area, 2)
    lamps = [*(float(lamp.power.mean()) for lamp in scene.lights.luminaires), *power.tolist()]
    suns = [
        Light(place, place[None], float(sun.irradiance.mean()), np.zeros(3))
        for sun in scene.lights.suns
        for place in [np.append(sun.direction, 0.0)]
    ]
    order = np.argsort(-np.array(lamps), kind="stable")[:MOST]
    return [*suns, *(_lamp(scene, int(row), lamps[row]) for row in order if lamps[row] > 0)][:MOST]


def _lamp(scene: Scene, row: int, power: float) -> Light:
    """Return a luminaire, or a side of a face, by its row."""
    of_points = len(scene.lights.luminaires)
    if row < of_points:
        lamp = scene.lights.luminaires[row]
        points = lamp.position[None]
        if lamp.soft:
            first, second = (lamp.axes[i] * lamp.size[i] for i in (0, 1))
            points = _grid(lamp.position - (first + second) / 2, first, second, True)
        return Light(np.append(lamp.position, 1.0), _places(points), power, np.zeros(3), lamp)
    side, face = divmod(row - of_points, scene.n_faces)
    origin, first, second = (part[face] for part in scene.frames)
    points = _grid(origin, first, second, bool(scene.is_quad[face]))
    middle = origin + (first + second) / (2 if scene.is_quad[face] else 3)
    return Light(np.append(middle, 1.0), _places(points), power, scene.normal[face] * (-1 if side else 1), None, face)


def _grid(origin: np.ndarray, first: np.ndarray, second: np.ndarray, is_quad: bool) -> np.ndarray:
    """Return points that are spread evenly over a parallelogram or triangle, (k, 3): more along its longer edge."""
    long, wide = np.linalg.norm(first), np.linalg.norm(second)
    columns = int(np.clip(np.round(np.sqrt(POINTS * long / max(wide, 1e-300))), 1, POINTS))
    rows = max(round(POINTS / columns), 1)
    u, v = (x.ravel() for x in np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows))
    if not is_quad:
        u, v = (np.where(u + v > 1, 1 - x, x) for x in (u, v))
    return origin + u[:, None] * first + v[:, None] * second


def _places(points: np.ndarray) -> np.ndarray:
    return np.concatenate([points, np.ones((len(points), 1))], axis=1)
