"""Means of linear functions that are cut off at a limit."""

import numpy as np


def mean_below(corners: np.ndarray, limit: float) -> np.ndarray:
    """Return means over triangles of linear functions cut off at ``limit``, (m, n); values at the corners are (m, 3, n)."""
    low, middle, high = np.moveaxis(np.sort(corners, axis=1), 1, 0)
    mean = corners.mean(axis=1)

    def corner(size, one, two):
        """Integral of what lies beyond a cut near a corner, ``size`` deep; the corner's differences to the others."""
        product = one * two
        return np.where(product > 0, size**3 / (3 * np.where(product > 0, product, 1)), 0)

    above = corner(high - limit, high - low, high - middle)
    below = mean - limit + corner(limit - low, middle - low, high - low)
    return np.where(high <= limit, mean, np.where(low >= limit, limit, mean - np.where(middle < limit, above, below)))
