"""The geometry of faces: frames, normals, and the numbers that place their planes. Areas are in `scene.measures`."""

import numpy as np

from .precision import plane_reach

Frames = tuple[np.ndarray, np.ndarray, np.ndarray]  # origin and two edges of each face, (n_faces, 3) each


def frames_of(vertices: np.ndarray, faces: np.ndarray) -> Frames:
    """Return origin and two edges of faces, (n_faces, 4): a point is origin + u edge_1 + v edge_2."""
    corners = vertices[faces[:, :3]]
    last = np.where(faces[:, 3] >= 0, faces[:, 3], faces[:, 2])
    return corners[:, 0], corners[:, 1] - corners[:, 0], vertices[last] - corners[:, 0]


def unit_normals(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return unit normals, (n, 3), of faces with these edges, (n, 3) each."""
    cross = np.cross(first, second)
    return cross / np.linalg.norm(cross, axis=1, keepdims=True)


def plane_reach_of(vertices: np.ndarray, faces: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return the size of the numbers that place each face's plane, (n_faces,) m.

    Args:
        vertices: (n_vertices, 3) m, about the scene's centre.
    """
    return plane_reach(normal, vertices[np.where(faces < 0, faces[:, :1], faces)])
