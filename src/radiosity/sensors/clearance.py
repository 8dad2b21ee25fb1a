"""How far in front of a sensor its lines begin, so that the rounding of a face that it lies on does not cover it."""

import numpy as np

from ..scene.precision import OFFSET
from ..tracing.faces import Faces

ON = 2.0  # plane offsets: a sensor that is nearer to a face's plane, in front or behind, lies on it
LEAST = 0.1  # cosine of a sensor's normal and a face's: others do not lead away from the plane


def clearance(faces: Faces, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Return the least distance along each sensor's normal at which its lines begin, (n,) float64.

    Args:
        points: (n, 3) in the BVH's coordinates.
        normals: (n, 3) of unit length.
    """
    needed = np.zeros(len(points))
    order = np.argsort(points[:, 0], kind="stable")
    sorted_x, own = points[order, 0], OFFSET * np.abs(points).max(axis=1)
    planes = faces.plane_offsets
    near = (ON * planes)[:, None]
    low, high = faces.corners.min(axis=1) - near, faces.corners.max(axis=1) + near
    begin, end = np.searchsorted(sorted_x, low[:, 0]), np.searchsorted(sorted_x, high[:, 0], side="right")
    for face in np.flatnonzero(end > begin):
        rows = order[begin[face] : end[face]]
        rows = rows[((points[rows] >= low[face]) & (points[rows] <= high[face])).all(axis=1)]
        cosine = normals[rows] @ faces.normals[face]
        away = (points[rows] - faces.corners[face, 0]) @ faces.normals[face] * np.sign(cosine)  # negative: behind
        limit = ON * np.maximum(planes[face], own[rows])
        on = (np.abs(away) <= limit) & (np.abs(cosine) > LEAST)
        rows, cosine, away = rows[on], np.abs(cosine[on]), away[on]
        needed[rows] = np.maximum(needed[rows], (np.maximum(planes[face], own[rows]) + np.maximum(-away, 0)) / cosine)
    return needed
