"""The form factor from a point to a polygon, exactly (J. H. Lambert, "Photometria", 1760; e.g. D. R. Baum, H. E. Rushmeier and
J. M. Winget, "Improving radiosity solutions through the use of analytically determined form-factors", SIGGRAPH 1989)."""

import numpy as np

from .clipping import ROUNDING, heights, in_front, normal_of

FAR = 1e4  # distance over radius: beyond it one point stands for the polygon (error 1e-8), below it sums of angles keep 8 digits
CHUNK = 1 << 16


def from_points(points: np.ndarray, normals: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(m,) float64 in [0, 1]: share of what leaves a point that arrives at a polygon, for m pairs, as if nothing else were there.

    1 / (2 pi) times the sum over edges of the angle under which each is seen, times the cosine between the normal and that of the
    triangle from the point to the edge. What lies below the point's horizon is cut away; from behind polygons give exactly zero.

    Args:
        points, normals: (m, 3), metres and unit vectors.
        corners: (m, 4, 3), metres, counterclockwise seen from the radiating side; triangles repeat their last one.
    """
    points, normals = (np.asarray(x, np.float64).reshape(-1, 3) for x in (points, normals))
    corners = np.asarray(corners, np.float64).reshape(-1, 4, 3)
    rows = [slice(at, at + CHUNK) for at in range(0, len(points), CHUNK)]
    parts = [_chunk(points[r], normals[r], corners[r]) for r in rows]
    return np.concatenate(parts) if parts else np.zeros(0)


def _chunk(points: np.ndarray, normals: np.ndarray, corners: np.ndarray) -> np.ndarray:
    rounding = ROUNDING * np.maximum(np.abs(points).max(axis=1), np.abs(corners).max(axis=(1, 2)))
    rim, origin = corners - points[:, None, :], np.zeros_like(points)
    area = normal_of(rim)
    above = heights(rim, origin, normals, rounding)
    seen = heights(origin[:, None, :], rim.mean(axis=1), area, rounding)[:, 0] > 0
    cut = in_front(rim, above)
    middle = cut.mean(axis=1)
    distance = np.linalg.norm(middle, axis=1)
    far = distance > FAR * np.linalg.norm(cut - middle[:, None, :], axis=2).max(axis=1)
    result = np.where(far, _one_point(middle, normal_of(cut), normals), _angles(cut, normals))
    return np.where(seen & (above > 0).any(axis=1), np.clip(result, 0, 1), 0)


def _angles(rim: np.ndarray, normals: np.ndarray) -> np.ndarray:
    following = np.roll(rim, -1, axis=1)
    cross = np.cross(following, rim)  # polygons are seen clockwise from the side that they do not radiate to
    sine = np.linalg.norm(cross, axis=2)
    angle = np.arctan2(sine, np.einsum("mkx,mkx->mk", rim, following))
    cosine = np.einsum("mkx,mx->mk", cross, normals) / np.where(sine > 0, sine, 1)
    return (angle * cosine).sum(axis=1) / (2 * np.pi)


def _one_point(way: np.ndarray, area: np.ndarray, normals: np.ndarray) -> np.ndarray:
    square = np.maximum((way**2).sum(axis=1), np.finfo(np.float64).tiny)
    return (way * normals).sum(axis=1) * -(way * area).sum(axis=1) / (np.pi * square * square)
