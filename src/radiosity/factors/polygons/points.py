"""The share of what leaves a point that arrives at a polygon, without obstacles: exact, horizon included.

J. H. Lambert, "Photometria", 1760: F = 1/(2 pi) sum over edges of n . g_i. The length of g_i is the angle under which the edge is
seen, and its direction is at right angles to the triangle of the point and the edge. What lies below the point's horizon is cut
off.
"""

import numpy as np


def from_points(points: np.ndarray, normals: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return form factors from m points to a polygon each.

    Args:
        points: (m, 3) metres, not on the polygon's rim.
        normals: (m, 3) unit normals of the points' surfaces.
        corners: (m, 4, 3) metres, convex, counterclockwise seen from the polygon's radiating side; a triangle repeats one.

    Returns:
        (m,) float64 in [0, 1]; zero for points behind the polygon.
    """
    to = corners - points[:, None, :]
    height = np.einsum("mki,mi->mk", to, normals)
    above = height > 0
    following, next_above = np.roll(to, -1, axis=1), np.roll(above, -1, axis=1)
    fall = height - np.roll(height, -1, axis=1)
    crossing = above != next_above
    share = np.where(crossing, height / np.where(crossing, fall, 1), 0)[:, :, None]
    cut = to + share * (following - to)  # where an edge meets the horizon
    start, end = np.where(above[:, :, None], to, cut), np.where(next_above[:, :, None], following, cut)
    total = _edge(start, end, normals, above | next_above).sum(axis=1)
    # a polygon that is cut off has an edge along the horizon, from where it goes below to where it comes up again
    sets, rises = ((cut * mask[:, :, None]).sum(axis=1) for mask in (crossing & above, crossing & next_above))
    total += _edge(sets[:, None], rises[:, None], normals, crossing.any(axis=1)[:, None])[:, 0]
    return np.clip(total / -(2 * np.pi), 0, 1) + 0.0  # no -0


def _edge(start: np.ndarray, end: np.ndarray, normals: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Return n . g, (m, k), of edges between vectors from the point, (m, k, 3) each; zero where masked out or seen end on."""
    cross = np.cross(start, end)
    sine = np.linalg.norm(cross, axis=2)
    angle = np.arctan2(sine, np.einsum("mki,mki->mk", start, end))
    seen = mask & (sine > 0)
    return np.where(seen, angle / np.where(seen, sine, 1) * np.einsum("mki,mi->mk", cross, normals), 0)
