"""Welding points to vertices: those of equal positions in one group, with normals that do not form a crease."""

import numpy as np

CREASE = 30.0  # degrees between normals, above which an edge stays sharp
BINS = 16.0  # normals that agree to a sixteenth count as one before angles are compared


def weld(points: np.ndarray, group: np.ndarray, normal: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
    """Number points so that those of one position and group share a number, unless a crease lies between them.

    Normals that meet at a position are joined pairwise where they differ by at most `CREASE`, and transitively.

    Args:
        points: (m, 3) metres.
        group: (m,) int, points of different groups are never joined.
        normal: (m, 3) unit normals of the faces that the points belong to.
        tolerance: (m,) metres, equal within a group; positions that round alike to it are equal.

    Returns:
        (m,) int64, numbers from 0 without gaps.
    """
    if len(points) == 0:
        return np.zeros(0, np.int64)
    low = points.min(axis=0)
    # the odd fraction keeps round numbers, which scenes are made of, off the rims of the rounding cells
    place = np.floor((points - low) / tolerance[:, None] + 0.3819660112501052).astype(np.int64)
    position = _combine(group, *place.T)
    leaning = _combine(position, *np.rint(normal * BINS).astype(np.int64).T)
    _, first, entry = np.unique(leaning, return_index=True, return_inverse=True)
    position, normal = position[first], normal[first]
    a, b = _pairs(position)
    smooth = np.einsum("ij,ij->i", normal[a], normal[b]) >= np.cos(np.deg2rad(CREASE))
    return _components(a[smooth], b[smooth], len(first))[entry]


def _combine(*keys: np.ndarray) -> np.ndarray:
    """Return one int64 for each tuple of keys, equal where the tuples are equal, from 0 without gaps."""
    result, size = np.zeros(len(keys[0]), np.int64), 1
    for key in keys:
        key = key - key.min()
        span = int(key.max()) + 1
        if size * span >= 2**62:  # closing the gaps needs a sort, so it is done only when the product would overflow
            result, size = _ranks(result)
            key, span = _ranks(key) if size * span >= 2**62 else (key, span)
        result, size = result * span + key, size * span
    return _ranks(result)[0]


def _ranks(key: np.ndarray) -> tuple[np.ndarray, int]:
    values, rank = np.unique(key, return_inverse=True)
    return rank, len(values)


def _pairs(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return all pairs of entries at one position."""
    order = np.argsort(position, kind="stable")
    count = np.bincount(position)
    start = np.cumsum(count) - count
    within = np.arange(len(order)) - start[position[order]]
    # the i-th entry of a position is paired with the i entries before it
    b = np.repeat(np.arange(len(order)), within)
    step = np.arange(len(b)) - np.repeat(np.cumsum(within) - within, within)
    return order[b - 1 - step], order[b]


def _components(a: np.ndarray, b: np.ndarray, n: int) -> np.ndarray:
    """Return the number of the connected component of each of n entries, given the linked pairs."""
    label = np.arange(n)
    while (label[a] != label[b]).any():
        low = np.minimum(label[a], label[b])
        np.minimum.at(label, label[a], low)
        np.minimum.at(label, label[b], low)
        while (label[label] != label).any():
            label = label[label]
    return _ranks(label)[0]
