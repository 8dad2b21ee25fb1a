"""Closed shells of triangles whose fronts look inward are turned: mirrored items of IFC files come out inside out."""

import numpy as np

SAME = 1e-6  # of the extent: vertices that are nearer are one


def mended(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """Triangles with the fronts of closed shells outside.

    The signed volume of a closed shell tells which way it looks. A shell within another that looks the other way is the wall of a
    cavity, and stays the opposite of the shell around it.

    Returns:
        (m, 3) triangles, (m,) bool where they belong to a closed shell, and how many shells were turned.
    """
    parts, closed = _shells(vertices, triangles)
    result, turned = triangles.copy(), 0
    solid = np.flatnonzero(closed)
    boxes = [_box(vertices, triangles[parts == i]) for i in solid]
    volumes = [_volume(vertices, triangles[parts == i]) for i in solid]
    flipped: dict[int, bool] = {}
    for i in sorted(range(len(solid)), key=lambda i: -np.prod(boxes[i][1] - boxes[i][0])):
        around = [j for j in flipped if (boxes[j][0] < boxes[i][0]).all() and (boxes[j][1] > boxes[i][1]).all()]
        outer = around[-1] if around else None  # the smallest one
        cavity = outer is not None and volumes[i] * volumes[outer] < 0
        flipped[i] = flipped[outer] if outer is not None and cavity else volumes[i] < 0
        if flipped[i]:
            rows = parts == solid[i]
            result[rows] = result[rows][:, ::-1]
            turned += 1
    return result, closed[parts], turned


def _shells(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The number of each triangle's shell, and which shells are closed: each edge runs once in either direction."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    size = max(float(np.ptp(vertices, axis=0).max(initial=0)), 1e-30)
    place = np.unique(np.round((vertices - vertices.min(axis=0)) / (SAME * size)), axis=0, return_inverse=True)[1].ravel()
    corners = place[triangles]
    count = len(corners)
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    whose = np.tile(np.arange(count), 3)
    low, high = edges.min(axis=1), edges.max(axis=1)
    key, inverse = np.unique(low * (place.max() + 1) + high, return_inverse=True)
    pairs = coo_matrix((np.ones(len(whose)), (whose, inverse.ravel())), shape=(count, len(key))).tocsr()
    parts = connected_components(pairs @ pairs.T, directed=False)[1]
    direction = np.bincount(inverse.ravel(), weights=np.where(edges[:, 0] < edges[:, 1], 1, -1), minlength=len(key))
    times = np.bincount(inverse.ravel(), minlength=len(key))
    open_edge = (direction != 0) | (times % 2 != 0)
    closed = np.ones(parts.max() + 1, bool)
    closed[parts[whose[open_edge[inverse.ravel()]]]] = False
    return parts, closed


def _volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    points = vertices[triangles] - vertices[triangles[0, 0]]
    return float(np.einsum("ij,ij->i", points[:, 0], np.cross(points[:, 1], points[:, 2])).sum()) / 6


def _box(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    points = vertices[triangles].reshape(-1, 3)
    return points.min(axis=0), points.max(axis=0)
