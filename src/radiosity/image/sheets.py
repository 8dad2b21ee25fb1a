"""Grid points of subdivided faces: numbered by arithmetic, placed, and joined where faces of one surface meet."""

import numpy as np

from ..patches import Patches
from ..scene import Back
from .weld import weld

EDGE_SHARE = 0.01  # of a surface's shortest cell edge: closer points are one vertex
CHUNK = 1 << 18  # rows at a time, where temporary arrays are large


class Sheets:
    """The grid points of every radiating side of every face, numbered sheet by sheet (face, side), row by row.

    A triangle with k points on its first edge has k - y points in row y, which begins at point y (2k - y + 1) / 2.
    """

    def __init__(self, patches: Patches):
        self.scene, self.columns, self.rows = patches.scene, patches.columns.astype(np.int64), patches.rows.astype(np.int64)
        k = self.columns + 1
        self.points = np.where(self.scene.is_quad, k * (self.rows + 1), k * (k + 1) // 2)
        sides = np.where(self.scene.back == Back.RADIATES, 2, 1)
        self.first = np.concatenate([[0], np.cumsum(self.points * sides)])

    def number(self, face: np.ndarray, back: np.ndarray, corner: np.ndarray) -> np.ndarray:
        """Return numbers of grid points; ``corner`` holds column and row, (m, 4, 2)."""
        x, y, k = corner[..., 0], corner[..., 1], self.columns[face][:, None] + 1
        local = np.where(self.scene.is_quad[face][:, None], y * k + x, y * (2 * k - y + 1) // 2 + x)
        return (self.first[face] + np.where(back, self.points[face], 0))[:, None] + local

    def welded(self) -> tuple[np.ndarray, np.ndarray]:
        """Return vertices, (n_vertices, 3), metres, and the vertex of each grid point, int32."""
        positions, rim = np.empty((self.first[-1], 3)), np.empty(self.first[-1], bool)
        face = np.repeat(np.arange(len(self.points), dtype=np.int32), np.diff(self.first))
        for begin in range(0, len(face), CHUNK):
            part = slice(begin, begin + CHUNK)
            positions[part], rim[part] = self._place(face[part], np.arange(begin, begin + len(face[part])))
        index = np.flatnonzero(rim)
        owner = face[index]
        back = index - self.first[owner] >= self.points[owner]
        group = 2 * self.scene.surface[owner].astype(np.int64) + back
        shared = weld(positions[index], group, self.scene.normal[owner], self._tolerance()[self.scene.surface[owner]])
        n_shared = int(shared.max(initial=-1)) + 1
        renumber = np.empty(len(face), np.int32)
        renumber[index] = shared
        renumber[~rim] = n_shared + np.arange(len(face) - len(index))
        vertices = np.empty((n_shared + len(face) - len(index), 3))
        vertices[renumber] = positions
        return vertices, renumber

    def _place(self, face: np.ndarray, number: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        columns, rows, quad = self.columns[face], self.rows[face], self.scene.is_quad[face]
        local = (number - self.first[face]) % self.points[face]
        k = columns + 1
        y = np.where(quad, local // k, np.floor(k + 0.5 - np.sqrt(np.maximum((k + 0.5) ** 2 - 2 * local, 0.25))).astype(np.int64))
        x = local - np.where(quad, y * k, y * (2 * k - y + 1) // 2)
        rim = (x == 0) | (y == 0) | np.where(quad, (x == columns) | (y == rows), x + y == columns)
        origin, first, second = (edge[face] for edge in self.scene.frames)
        return origin + (x / columns)[:, None] * first + (y / rows)[:, None] * second, rim

    def _tolerance(self) -> np.ndarray:
        """Return the distance below which points are one vertex, (n_surfaces,), metres."""
        _, first, second = self.scene.frames
        edges = [np.linalg.norm(first, axis=1) / self.columns, np.linalg.norm(second, axis=1) / self.rows]
        edges.append(np.where(self.scene.is_quad, np.inf, np.linalg.norm(second - first, axis=1) / self.columns))
        shortest = np.full(len(self.scene.names), np.inf)
        np.minimum.at(shortest, self.scene.surface, np.min(edges, axis=0))
        return np.maximum(EDGE_SHARE * shortest, 1e-12 * float(np.ptp(self.scene.bounds, axis=0).max()))
