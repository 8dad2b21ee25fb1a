"""The geometry of the elements of a hierarchy: corners, points, areas and normals by arithmetic."""

import numpy as np

from . import cells
from .hierarchy import Hierarchy


def area(hierarchy: Hierarchy, element: np.ndarray) -> np.ndarray:
    """Return areas, (m,) float64, m²."""
    side, level, *_ = hierarchy.place(element)
    columns, rows = hierarchy.grid(side, level)
    return hierarchy.patches.scene.area[hierarchy.side_face[side]] / cells.count(columns, rows)


def normal(hierarchy: Hierarchy, element: np.ndarray) -> np.ndarray:
    """Return normals of unit length, (m, 3) float64, which point to the radiating side."""
    side = hierarchy.side(element)
    sign = np.where(hierarchy.side_is_back[side], -1.0, 1.0)
    return hierarchy.patches.scene.normal[hierarchy.side_face[side]] * sign[:, None]


def is_quad(hierarchy: Hierarchy, element: np.ndarray) -> np.ndarray:
    """Return which elements are parallelograms and not triangles, (m,) bool."""
    return hierarchy.patches.scene.is_quad[hierarchy.face(element)]


def corners(hierarchy: Hierarchy, element: np.ndarray) -> np.ndarray:
    """Return corners, (m, 4, 3) float64, metres, counterclockwise seen from the element's side; a triangle repeats its last."""
    side, level, column, row, inverted = hierarchy.place(element)
    quad = hierarchy.patches.scene.is_quad[hierarchy.side_face[side]]
    uv = cells.corners(column, row, inverted, *hierarchy.grid(side, level), quad)
    turned = np.where(quad[:, None], [0, 3, 2, 1], [0, 2, 1, 1])
    order = np.where(hierarchy.side_is_back[side][:, None], turned, [0, 1, 2, 3])
    return _points(hierarchy, side, np.take_along_axis(uv, order[:, :, None], axis=1))


def points(hierarchy: Hierarchy, element: np.ndarray, square: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Return points at the same places of all elements.

    Args:
        square: (q, 2), coordinates in a parallelogram, 0 to 1 along its edges.
        half: (q, 2), coordinates in a triangle, with a sum of at most 1.

    Returns:
        (m, q, 3) float64, metres.
    """
    side, level, column, row, inverted = hierarchy.place(element)
    quad = hierarchy.patches.scene.is_quad[hierarchy.side_face[side]]
    within = np.where(quad[:, None, None], square, np.where(inverted[:, None, None], 1 - half, half))
    start = np.stack([column, row], axis=1)[:, None, :]
    return _points(hierarchy, side, (start + within) / np.stack(hierarchy.grid(side, level), axis=1)[:, None, :])


def centroid(hierarchy: Hierarchy, element: np.ndarray) -> np.ndarray:
    """Return centroids, (m, 3) float64, metres."""
    return points(hierarchy, element, np.full((1, 2), 0.5), np.full((1, 2), 1 / 3))[:, 0]


def _points(hierarchy: Hierarchy, side: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Return points, (m, q, 3), from face coordinates, (m, q, 2)."""
    origin, first, second = (edge[hierarchy.side_face[side]][:, None, :] for edge in hierarchy.patches.scene.frames)
    return origin + uv[:, :, :1] * first + uv[:, :, 1:] * second
