"""Convex polygons cut by a plane (I. E. Sutherland and G. W. Hodgman, "Reentrant polygon clipping", CACM 17(1), 1974)."""

import numpy as np

from .short_axes import largest, lengths

ROUNDING = 32 * np.finfo(np.float64).eps  # of the largest coordinate: points nearer than this lie in the plane
FLAT = 1e-11  # of the largest distance: points nearer than this lie in the plane, too


def normal_of(corners: np.ndarray) -> np.ndarray:
    """Return area vectors, (m, 3), m², of polygons (m, k, 3): area times the normal, on the counterclockwise side."""
    spokes = corners[:, 1:] - corners[:, :1]
    return np.cross(spokes[:, :-1], spokes[:, 1:]).sum(axis=1) / 2


def heights(corners: np.ndarray, point: np.ndarray, normal: np.ndarray, rounding: np.ndarray) -> np.ndarray:
    """Return distances of corners in front of planes, (m, k), metres; exactly zero where they cannot be told from zero.

    Args:
        point, normal: (m, 3), the planes; normals of any length.
        rounding: (m,) metres, the accuracy of coordinates.
    """
    way = corners - point[:, None, :]
    length = lengths(normal)[:, None]
    height = np.einsum("mkx,mx->mk", way, np.divide(normal, length, out=np.zeros_like(normal), where=length > 0))
    least = rounding + FLAT * largest(lengths(way))
    return np.where(np.abs(height) <= least[:, None], 0.0, height)


def in_front(corners: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Return the parts of polygons in front of planes, (m, k + 1, 3), counterclockwise as before.

    Corners are repeated to fill up. Where nothing is left, or only what lies in the plane, all corners are one point.

    Args:
        corners: (m, k, 3), convex. height: (m, k), of the corners in front of the plane.
    """
    m, k = height.shape
    following, rises = np.roll(corners, -1, axis=1), np.roll(height, -1, axis=1)
    crosses = height * rises < 0
    share = np.divide(height, height - rises, out=np.zeros_like(height), where=crosses)
    # each corner and where the edge after it crosses, in order; those that stay are moved to the front
    points = np.stack([corners, corners + share[:, :, None] * (following - corners)], axis=2).reshape(m, 2 * k, 3)
    stays = np.stack([height >= 0, crosses], axis=2).reshape(m, 2 * k)
    order = np.argsort(~stays, axis=1, kind="stable")[:, : k + 1]
    kept = np.take_along_axis(points, order[:, :, None], axis=1)
    stays = np.take_along_axis(stays, order, axis=1)
    something = np.any(height > 0, axis=1)
    return np.where(stays[:, :, None] & something[:, None, None], kept, kept[:, :1])
