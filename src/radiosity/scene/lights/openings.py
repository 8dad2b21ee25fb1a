"""Openings from corners: parallelograms and triangles in a plane."""

import numpy as np
from numpy.typing import ArrayLike

from ...errors import SceneError

FLAT = 1e-6  # of its size: so far the fourth corner of an opening may stand from the plane of the others


def opening(corners: ArrayLike, what: str) -> np.ndarray:
    """Return three or four corners around as openings, (n, 4, 3): a parallelogram, or triangles.

    Raises:
        SceneError: they are no corners around a convex polygon in a plane.
    """
    try:
        points = np.array(corners, np.float64)
    except (TypeError, ValueError):
        points = np.zeros(0)
    if points.shape not in ((3, 3), (4, 3)):
        raise SceneError(f"{what}: has the shape {points.shape}; give three or four corners of three numbers each")
    if not np.isfinite(points).all():
        raise SceneError(
            f"{what}: {points[~np.isfinite(points).all(axis=1)][0].tolist()} is no corner; give three finite numbers"
        )
    if len(points) == 3:
        points = points[[0, 1, 2, 2]]
    size = np.ptp(points, axis=0).max()
    cross = np.cross(points[1] - points[0], points[2] - points[0])
    if not np.linalg.norm(cross) > FLAT * size**2:
        raise SceneError(f"{what}: its corners lie on a line; move one")
    if abs((points[3] - points[0]) @ cross) / np.linalg.norm(cross) > FLAT * size:
        raise SceneError(f"{what}: its fourth corner lies off the plane of the others; give two openings of three corners")
    if (points[2] == points[3]).all() or np.abs(points[1] - points[0] + points[3] - points[2]).max() <= FLAT * size:
        return points[None]
    turns = [np.cross(points[i] - points[i - 1], points[(i + 1) % 4] - points[i]) @ cross for i in range(4)]
    if min(turns) <= 0:
        raise SceneError(f"{what}: its corners do not run around a convex polygon; give two openings of three corners")
    return points[[[0, 1, 2, 2], [0, 2, 3, 3]]]
