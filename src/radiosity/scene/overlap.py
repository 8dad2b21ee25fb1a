"""The overlap of convex polygons of up to four corners in a plane, for many pairs at a time."""

import numpy as np


def overlapping(one: np.ndarray, two: np.ndarray, least: np.ndarray) -> np.ndarray:
    """Return whether two faces share more than a length along every direction across an edge of either, (m,) bool.

    It is the test of separating axes.

    Args:
        one, two: (m, 4, 2) corners in order; triangles repeat one.
        least: (m,) that length.
    """
    rows = np.arange(len(one))
    for polygons in (0, 1):
        for edge in range(4):
            shape = (one, two)[polygons][rows]
            along = shape[:, (edge + 1) % 4] - shape[:, edge]
            length = np.linalg.norm(along, axis=1)
            across = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.where(length > 0, length, 1)[:, None]
            a, b = (np.einsum("mki,mi->mk", p[rows], across) for p in (one, two))
            shared = np.minimum(a.max(axis=1), b.max(axis=1)) - np.maximum(a.min(axis=1), b.min(axis=1))
            rows = rows[(shared > least[rows]) | (length == 0)]
    result = np.zeros(len(one), bool)
    result[rows] = True
    return result


def common(one: np.ndarray, two: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the part that both cover: (m, 8, 2) corners, the last one repeated, and (m,) area; zeros where there is none.

    It cuts ``two`` along the edges of ``one`` (I. Sutherland, G. Hodgman, "Reentrant polygon clipping", CACM 17(1), 1974).

    Args:
        one: (m, 4, 2) counterclockwise.
        two: (m, 4, 2) in either direction.
    """
    shape, count = two, np.full(len(two), 4)
    for edge in range(4):
        start, along = one[:, edge], one[:, (edge + 1) % 4] - one[:, edge]
        shape, count = _cut(shape, count, start, along)
    return shape, _area(shape)


def _cut(shape: np.ndarray, count: np.ndarray, start: np.ndarray, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the part of polygons to the left of lines."""
    offset = shape - start[:, None]
    height = along[:, None, 0] * offset[..., 1] - along[:, None, 1] * offset[..., 0]
    k = shape.shape[1]
    after = np.where(np.arange(k) + 1 < count[:, None], np.arange(k) + 1, 0)
    next_shape = np.take_along_axis(shape, after[..., None], axis=1)
    next_height = np.take_along_axis(height, after, axis=1)
    there = np.arange(k) < count[:, None]
    inside, crosses = there & (height >= 0), there & ((height >= 0) != (next_height >= 0))
    part = np.divide(height, height - next_height, out=np.zeros_like(height), where=crosses)
    both = np.stack([shape, shape + part[..., None] * (next_shape - shape)], axis=2).reshape(len(shape), 2 * k, 2)
    kept = np.stack([inside, crosses], axis=2).reshape(len(shape), 2 * k)
    order = np.argsort(~kept, axis=1, kind="stable")[:, :8]
    count = kept.sum(axis=1)
    cut = np.take_along_axis(both, order[..., None], axis=1)
    last = np.take_along_axis(cut, np.maximum(count - 1, 0)[:, None, None], axis=1)
    cut = np.where((np.arange(cut.shape[1]) < count[:, None])[..., None], cut, last)
    return np.where((count > 0)[:, None, None], cut, 0.0), count


def _area(shape: np.ndarray) -> np.ndarray:
    after = np.roll(shape, -1, axis=1)
    return np.abs((shape[..., 0] * after[..., 1] - shape[..., 1] * after[..., 0]).sum(axis=1)) / 2
