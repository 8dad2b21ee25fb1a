"""The resolution of single precision: the centre of coordinates, and the size of an ulp about it.

Lines are traced in single precision, about the scene's centre. The centre is a median, so that an object far away does not change
the precision of all others. The rounding at a point depends on the numbers near it, not on the size of the scene.
"""

import numpy as np

EPSILON = float(np.finfo(np.float32).eps)
OFFSET = 8 * EPSILON  # of the largest number that places a point or its plane: lines begin this far in front of it
TIE = 1e-9  # share of the area: where less decides, the lower of two medians is taken, however sums are rounded


def median_centre(centroid: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Return the area-weighted median of the faces' centroids, axis by axis, (3,) float64 metres.

    Args:
        centroid: (n_faces, 3) metres.
        area: (n_faces,) m², whose sum is above zero.
    """
    centre = np.empty(3)
    for axis in range(3):
        order = np.argsort(centroid[:, axis], kind="stable")
        sums = np.cumsum(area[order])
        centre[axis] = centroid[order[np.searchsorted(sums, sums[-1] / 2 * (1 - TIE))], axis]
    return centre


def plane_reach(normal: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the size of the numbers that place a face's plane, (m,) float64: its shift by their rounding, over an ulp of one.

    For a face that stands across an axis it is the distance along that axis, however far the face reaches.

    Args:
        normal: (m, 3).
        corners: (m, k, 3) about the centre.
    """
    return np.einsum("mi,mi->m", np.abs(normal), np.abs(corners).max(axis=1))


def ulp(points: np.ndarray, centre: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Return an ulp of single precision of the largest number that places a point or its face's plane, (m,) float64 metres.

    Args:
        points: (m, 3) metres.
        centre: (3,) metres, the centre of the scene.
        reach: (m,) metres, the `plane_reach` of the face of each point.
    """
    return EPSILON * np.maximum(np.abs(points - centre).max(axis=1), reach)
