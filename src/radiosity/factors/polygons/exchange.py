"""Exact exchange areas of pairs of convex polygons with nothing between them."""

import numpy as np

from .areas import over_both
from .clipping import ROUNDING, heights, in_front, normal_of
from .contour import around
from .short_axes import largest, lengths, middles, smallest

FAR = 10.0  # distance of middles over the sum of the radii: beyond it areas are integrated, else rims; the error is 5e-8 in both
CHUNK = 1 << 13  # pairs at a time: about 100 MB


def exchange(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return A_i F_ij = A_j F_ji, (m,) float64, m², for m pairs of convex polygons as if nothing else were there.

    Parts behind the other's plane are cut away first. Polygons behind each other, or in one plane, give exactly zero. Neither
    place nor size changes the accuracy.

    Args:
        one, other: (m, 4, 3) float64, metres, corners counterclockwise seen from the radiating side; triangles repeat their last.
    """
    one, other = (np.asarray(x, np.float64).reshape(-1, 4, 3) for x in (one, other))
    parts = [_chunk(one[at : at + CHUNK], other[at : at + CHUNK]) for at in range(0, len(one), CHUNK)]
    return np.concatenate(parts) if parts else np.zeros(0)


def _chunk(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    rounding = ROUNDING * np.maximum(*(largest(np.abs(x).reshape(-1, 12)) for x in (one, other)))
    centre = ((middles(one) + middles(other)) / 2)[:, None]
    one, other = one - centre, other - centre
    size = np.maximum(largest(lengths(one)), largest(lengths(other)))
    size = np.maximum(size, np.finfo(np.float64).tiny)
    one, other, rounding = one / size[:, None, None], other / size[:, None, None], rounding / size
    above = heights(one, middles(other), normal_of(other), rounding)
    below = heights(other, middles(one), normal_of(one), rounding)
    faces = np.flatnonzero((largest(above) > 0) & (largest(below) > 0))
    result = np.zeros(len(one))
    result[faces] = _facing(one[faces], other[faces], above[faces], below[faces]) * size[faces] ** 2
    return result


def _facing(one: np.ndarray, other: np.ndarray, above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Return exchange areas, (m,), of polygons of which some parts see each other; lengths are about 1."""
    cut = (smallest(above) < 0) | (smallest(below) < 0)
    result = np.empty(len(one))
    for rows in (np.flatnonzero(~cut), np.flatnonzero(cut)):
        a, b = one[rows], other[rows]
        if len(rows) and cut[rows[0]]:
            a, b = in_front(a, above[rows]), in_front(b, below[rows])
        far = lengths(middles(b) - middles(a)) > FAR * (_radius(a) + _radius(b))
        for some, integral in ((np.flatnonzero(far), over_both), (np.flatnonzero(~far), around)):
            if len(some):
                result[rows[some]] = integral(a[some], b[some])
    return np.maximum(result, 0)  # what is left of nearly coplanar polygons is rounding of either sign


def _radius(polygons: np.ndarray) -> np.ndarray:
    return largest(lengths(polygons - middles(polygons)[:, None]))
