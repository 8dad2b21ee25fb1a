"""What single precision holds apart where a point lies: the centre of coordinates, and the size of an ulp about it.

Lines are traced in single precision, about the scene's centre. The centre is a median, so that an object far away leaves the
precision of all others as it was; and what is rounded at a point depends on the numbers near it, not on how far the scene
reaches.
"""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .model import Scene

EPSILON = float(np.finfo(np.float32).eps)
TIE = 1e-9  # of the area: where so little decides, the lower of two medians is taken, however sums are rounded


def median_centre(scene: "Scene") -> np.ndarray:
    """(3,) float64 metres: the area-weighted median of the faces' centroids, axis by axis; of a scene without area the middle of
    its box."""
    area = scene.area
    origin, first, second = scene.frames
    centroid = origin + (first + second) / np.where(scene.is_quad, 2.0, 3.0)[:, None]
    if not area.sum() > 0:
        return scene.bounds.mean(axis=0)
    centre = np.empty(3)
    for axis in range(3):
        order = np.argsort(centroid[:, axis], kind="stable")
        sums = np.cumsum(area[order])
        centre[axis] = centroid[order[np.searchsorted(sums, sums[-1] / 2 * (1 - TIE))], axis]
    return centre


def plane_reach(normal: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(m,) float64: the size of the numbers that place a face's plane: what their rounding moves it by, over an ulp of one.

    Of a face that stands across an axis it is the distance along that axis, however far the face reaches.

    Args:
        normal: (m, 3). corners: (m, k, 3) about the centre.
    """
    return np.einsum("mi,mi->m", np.abs(normal), np.abs(corners).max(axis=1))


def ulp(scene: "Scene", face: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(m,) float64 metres: an ulp of single precision at points of faces, of the largest number that places a point or its plane.

    Args:
        face: (m,) int. points: (m, 3) metres.
    """
    return EPSILON * np.maximum(np.abs(points - scene.centre).max(axis=1), scene.plane_reach[face])
