"""Exchange areas A_i F_ij of polygons far apart, by Gauss rules of degree five over both areas.

Their error falls with the sixth power of size over distance, while integrals along rims lose digits with its fourth power.
"""

import numpy as np

from .clipping import normal_of

# a triangle's rule of degree 5 (J. Radon, "Zur mechanischen Kubatur", Monatshefte für Mathematik 52, 1948)
_ROOT = np.sqrt(15)
_INNER, _OUTER = (6 - _ROOT) / 21, (6 + _ROOT) / 21
_SHARES = [(155 - _ROOT) / 1200, (155 + _ROOT) / 1200]
TRIANGLE = np.array([[1 / 3] * 3, *(np.roll([1 - 2 * b, b, b], i) for b in (_INNER, _OUTER) for i in range(3))])
TRIANGLE_WEIGHTS = np.array([9 / 40, *np.repeat(_SHARES, 3)])


def over_both(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return A_i F_ij, (m,), in units of length squared; arguments as in `contour.around`."""
    (points, weights), (ends, other_weights) = (_rule(p) for p in (one, other))
    normal, facing = (n / np.linalg.norm(n, axis=1, keepdims=True) for n in (normal_of(one), normal_of(other)))
    total = np.zeros(len(one))
    for i in range(points.shape[1]):  # for one point of the first polygon at a time: little memory
        way = ends - points[:, i, None, :]
        up, down = np.einsum("mpx,mx->mp", way, normal), -np.einsum("mpx,mx->mp", way, facing)
        kernel = np.maximum(up, 0) * np.maximum(down, 0) / np.einsum("mpx,mpx->mp", way, way) ** 2
        total += weights[:, i] * (kernel * other_weights).sum(axis=1)
    return total / np.pi


def _rule(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return points, (m, p, 3), and weights, (m, p), which sum to the area, over triangles from each polygon's first corner."""
    points, weights = [], []
    for k in range(1, corners.shape[1] - 1):
        triangle = corners[:, [0, k, k + 1]]
        area = np.linalg.norm(np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]), axis=1) / 2
        if area.any():
            points.append(np.einsum("pc,mcx->mpx", TRIANGLE, triangle))
            weights.append(area[:, None] * TRIANGLE_WEIGHTS)
    if not points:
        return corners[:, :1], np.zeros((len(corners), 1))
    return np.concatenate(points, axis=1), np.concatenate(weights, axis=1)
