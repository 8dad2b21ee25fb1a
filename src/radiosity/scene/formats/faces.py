"""Polygons of any number of corners as triangles and quadrilaterals."""

import numpy as np

from .polygon import triangulate


def cut(points: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Faces of polygons whose corners lie one after another; larger ones are cut into triangles, order is kept.

    Args:
        points: (n, 3) corners of all polygons.
        sizes: (n_polygons,) corners of each; those of fewer than three are left out.

    Returns:
        (m, 4) int64 numbers of corners, -1 in the last column of a triangle.
    """
    sizes = np.asarray(sizes, np.int64)
    starts = np.cumsum(sizes) - sizes
    found, row = [np.zeros((0, 4), np.int64)], [np.zeros(0, np.int64)]
    for size in (3, 4):
        rows = np.flatnonzero(sizes == size)
        found.append(starts[rows, None] + np.where(np.arange(4) < size, np.arange(4), 0))
        found[-1][:, size:] = -1
        row.append(rows)
    for large in np.flatnonzero(sizes > 4):
        ring = points[starts[large] : starts[large] + sizes[large]]
        triangles = triangulate(ring)[0] if np.isfinite(ring).all() else []
        # one without area or with bad numbers stays as one triangle, to be reported like others
        triangles = np.asarray(triangles if len(triangles) else [(0, 1, 2)]) + starts[large]
        found.append(np.column_stack([triangles, np.full(len(triangles), -1)]))
        row.append(np.full(len(triangles), large))
    return np.concatenate(found)[np.argsort(np.concatenate(row), kind="stable")]
