"""Reductions over short axes, entry by entry: quicker than numpy's own, which are made for long ones, and to the same bits."""

from functools import reduce

import numpy as np


def lengths(vectors: np.ndarray) -> np.ndarray:
    """Return lengths of vectors, (..., 3) to (...)."""
    x, y, z = (vectors[..., i] for i in range(3))
    return np.sqrt(x * x + y * y + z * z)


def middles(polygons: np.ndarray) -> np.ndarray:
    """Return means of corners, (m, k, 3) to (m, 3)."""
    return reduce(np.add, (polygons[:, i] for i in range(polygons.shape[1]))) / polygons.shape[1]


def largest(values: np.ndarray) -> np.ndarray:
    """Return the largest of each row, (m, k) to (m,)."""
    return reduce(np.maximum, values.T)


def smallest(values: np.ndarray) -> np.ndarray:
    """Return the smallest of each row, (m, k) to (m,)."""
    return reduce(np.minimum, values.T)
