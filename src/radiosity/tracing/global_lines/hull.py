"""Sides of faces beyond which there is nothing: a line that leaves the scene there need not be traced."""

import numpy as np

from ...scene.precision import EPSILON
from ..faces import OFFSET
from ..geometry import Geometry

DIRECTIONS = 96  # the farthest vertices in so many directions sort out nearly all faces inside
MOST = 1 << 28  # products of faces and vertices: where more would be needed, no side is known to be free
FEW = 1 << 22  # products at a time
BESIDE = 4 * EPSILON  # of a vertex's largest coordinate: vertices this little in front of a plane lie in it


def nothing_beyond(geometry: Geometry) -> np.ndarray:
    """Return whether no vertex of the scene lies in front of each face, and whether none lies behind it: (n_faces, 2) bool."""
    vertices = geometry.bvh.vertices.astype(np.float64)
    vertices = vertices[np.unique(geometry.scene.faces[geometry.scene.faces >= 0])]
    origin, normal = geometry.faces.frames[0], geometry.faces.normals
    free = np.zeros((len(origin), 2), bool)
    extreme = vertices[np.unique(np.argmax(_sphere(DIRECTIONS) @ vertices.T, axis=1))]
    for side, outward in enumerate((normal, -normal)):
        height = np.einsum("ij,ij->i", outward, origin) + geometry.faces.plane_offsets * (BESIDE / OFFSET)
        rows = np.flatnonzero(_highest(outward, extreme) <= height)
        if len(rows) * len(vertices) <= MOST:
            free[rows, side] = _highest(outward[rows], vertices) <= height[rows]
    return free


def _highest(normals: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the largest height of points above a plane through the origin, for each normal, less what points are rounded by."""
    result, rounded = np.full(len(normals), -np.inf), BESIDE * np.abs(points).max(axis=1)
    at_once = max(1, FEW // max(len(points), 1))
    for start in range(0, len(normals), at_once):
        rows = slice(start, start + at_once)
        result[rows] = (normals[rows] @ points.T - rounded).max(axis=1)
    return result


def _sphere(count: int) -> np.ndarray:
    """Return directions about evenly on the sphere (a spiral), and the axes: (count + 6, 3)."""
    z = 1 - (2 * np.arange(count) + 1) / count
    angle = np.pi * (1 + 5**0.5) * np.arange(count)
    radius = np.sqrt(1 - z * z)
    spiral = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])
    return np.concatenate([spiral, np.eye(3), -np.eye(3)])
