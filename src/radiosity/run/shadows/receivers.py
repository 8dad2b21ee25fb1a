"""Sides of faces that may be cut where shadows end, and points on them that stand in a grid."""

from dataclasses import dataclass

import numpy as np

from ...patches.contact.cutting import LARGE
from ...scene.model import Back, Scene
from ...scene.split import bent
from .lights import Light

SIDES = 4096  # at most: those of the largest area times reflectance
POINTS = 1 << 17  # on all of them, about
FINE = 0.5  # of a patch's size: the distance of points
EACH = 4  # lights of a side, at most
SOME = 16  # points of a side, about, tell which lights are its strongest
FEWEST = 4  # points along an edge


@dataclass(frozen=True, eq=False)
class Receivers:
    """Sides with points on them.

    Attributes:
        face: (n_sides,) int64, the face of each. sign: (n_sides,) 1 for fronts, and -1 for backs.
        reflectance: (n_sides,) mean of bands.
        columns, rows: (n_sides,) int64, of the grid.
        side: (m,) int64, the side of each point: points of a side stand together, row by row.
        points: (m, 3) metres.
        inside: (m,) bool, it is a point of the face: grids of triangles are those of parallelograms.
        spacing: metres, of points.
    """

    face: np.ndarray
    sign: np.ndarray
    reflectance: np.ndarray
    columns: np.ndarray
    rows: np.ndarray
    side: np.ndarray
    points: np.ndarray
    inside: np.ndarray
    spacing: float

    @staticmethod
    def of(scene: Scene, size: float) -> "Receivers":
        """Return those of a scene.

        Args:
            size: metres, of the mean patch.
        """
        back = np.flatnonzero(scene.back == Back.RADIATES)
        face = np.concatenate([np.arange(scene.n_faces), back])
        sign = np.concatenate([np.ones(scene.n_faces), -np.ones(len(back))])
        rho = np.concatenate([scene.reflectance.mean(axis=1), scene.back_reflectance[back].mean(axis=1)])
        if not rho.any():  # all are black: what falls on them counts
            rho = np.ones(len(rho))
        worth = rho * scene.area[face] * ((scene.area > LARGE * size**2) & ~bent(scene))[face]
        some = np.sort(np.argsort(-worth, kind="stable")[: min(SIDES, int((worth > 0).sum()))])
        face, sign, rho = face[some], sign[some], rho[some]
        _, first, second = scene.frames
        spacing = max(FINE * size, float(np.sqrt(scene.area[face].sum() / POINTS)))
        columns, rows = (
            np.maximum(np.ceil(np.linalg.norm(edge[face], axis=1) / spacing), FEWEST).astype(np.int64) for edge in (first, second)
        )
        count = columns * rows
        side = np.repeat(np.arange(len(face)), count)
        at = np.arange(len(side)) - np.repeat(np.cumsum(count) - count, count)
        u, v = (at % columns[side] + 0.5) / columns[side], (at // columns[side] + 0.5) / rows[side]
        origin, first, second = (part[face][side] for part in scene.frames)
        inside = scene.is_quad[face][side] | (u + v < 1)
        points = origin + u[:, None] * first + v[:, None] * second
        return Receivers(face, sign, rho, columns, rows, side, points, inside, spacing)

    def normals(self, scene: Scene) -> np.ndarray:
        """Return the unit normals of the sides, (n_sides, 3)."""
        return scene.normal[self.face] * self.sign[:, None]

    def mean(self, values: np.ndarray) -> np.ndarray:
        """Return the mean over the points of each side, (n_sides,)."""
        weight = np.bincount(self.side, self.inside, len(self.face))
        return np.bincount(self.side, values * self.inside, len(self.face)) / np.maximum(weight, 1)

    def neighbours(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the pairs of points that are next to each other, (k,) int64 each."""
        count = self.columns * self.rows
        number = np.arange(len(self.side))
        at = number - np.repeat(np.cumsum(count) - count, count)
        columns, rows = self.columns[self.side], self.rows[self.side]
        along = number[(at % columns < columns - 1) & self.inside]
        across = number[(at // columns < rows - 1) & self.inside]
        one, two = np.concatenate([along, across]), np.concatenate([along + 1, across + columns[across]])
        return one[self.inside[two]], two[self.inside[two]]


def lit_by(scene: Scene, receivers: Receivers, lights: list[Light]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return for each light which points it may light, as one of the strongest of their side, (k,) int64, and its irradiance of
    them if nothing stands between, (k,)."""
    normals = receivers.normals(scene)
    count = receivers.columns * receivers.rows
    at = np.arange(len(receivers.side)) - np.repeat(np.cumsum(count) - count, count)
    step = np.maximum(count // SOME, 1)[receivers.side]
    some = np.flatnonzero((at % step == step // 2) & receivers.inside)
    of = receivers.side[some]
    means = np.zeros((len(lights), len(receivers.face)))
    for row, light in zip(means, lights, strict=True):
        row[:] = np.bincount(of, light.irradiance(receivers.points[some], normals[of], light.middle), len(row))
        row[receivers.face == light.face] = 0.0
    chosen = np.zeros(means.shape, bool)
    np.put_along_axis(chosen, np.argsort(-means, axis=0, kind="stable")[:EACH], True, axis=0)
    result = []
    for light, row in zip(lights, chosen & (means > 0), strict=True):
        points = np.flatnonzero(row[receivers.side] & receivers.inside)
        arriving = light.irradiance(receivers.points[points], normals[receivers.side[points]], light.middle)
        result.append((points[arriving > 0], arriving[arriving > 0]))
    return result
