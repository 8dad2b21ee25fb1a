"""Triangles of a flat polygon: concave, or with holes that seams (edges run both ways) join to its outline."""

import numpy as np


def vector_area(points: np.ndarray) -> np.ndarray:
    """(3,) area times normal of a closed polygon, points (n, 3), counterclockwise seen from the normal's side."""
    spokes = points[1:] - points[0]
    return np.cross(spokes[:-1], spokes[1:]).sum(axis=0) / 2


def triangulate(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Corners of triangles that fill a polygon, facing as it does.

    The polygon is cut as its projection on the plane of its mean normal; corners stay where they are.

    Args:
        points: (n, 3), n at least 3.

    Returns:
        (m, 3) int64 indices into ``points``, and the relative difference between the areas of the triangles and of the
        polygon: 0 but for rounding unless its outline crosses itself. No triangles where it has no area.
    """
    from mapbox_earcut import triangulate_float64

    normal = vector_area(points)
    area = np.linalg.norm(normal)
    reach = np.abs(points - points[0]).max()
    if not area > 1e-14 * reach**2:
        return np.zeros((0, 3), np.int64), 0.0
    axes = np.linalg.svd(normal[None])[2]  # normal first, up to sign
    turn = np.sign(np.linalg.det(axes) * (axes[0] @ normal))
    flat = (points - points[0]) @ axes[1:].T / reach * (1, turn)
    corners = triangulate_float64(np.ascontiguousarray(flat), np.array([len(flat)], np.uint32)).reshape(-1, 3).astype(np.int64)
    one, two, three = (flat[corners[:, i]] for i in range(3))
    signed = ((two - one)[:, 0] * (three - one)[:, 1] - (two - one)[:, 1] * (three - one)[:, 0]) / 2
    corners[signed < 0] = corners[signed < 0][:, ::-1]
    return corners, abs(float(np.abs(signed).sum()) * reach**2 / area - 1)
