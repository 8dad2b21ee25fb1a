"""Polygons of any number of corners as triangles and quadrilaterals."""

import numpy as np

from ...errors import shown
from ..assemble import warn
from .polygon import triangulate

CROSSING = 1e-6  # relative difference of areas that rounding does not make


def cut(points: np.ndarray, sizes: np.ndarray, crossed: list[int]) -> np.ndarray:
    """Faces of polygons whose corners lie one after another; larger ones are cut into triangles, order is kept.

    Args:
        points: (n, 3) corners of all polygons.
        sizes: (n_polygons,) corners of each; those of fewer than three are left out.
        crossed: numbers of polygons of more than four corners whose outline crosses itself are added, for `warn_of_crossing`;
            quadrilaterals are found where the scene is built.

    Returns:
        (m, 4) int64 numbers of corners, -1 in the last column of a triangle.
    """
    sizes = np.asarray(sizes, np.int64)
    if len(sizes) and sizes[0] in (3, 4) and (sizes == sizes[0]).all():
        faces = np.full((len(sizes), 4), -1)
        faces[:, : sizes[0]] = np.arange(sizes.sum()).reshape(len(sizes), -1)
        return faces
    starts = np.cumsum(sizes) - sizes
    found, row = [np.zeros((0, 4), np.int64)], [np.zeros(0, np.int64)]
    for size in (3, 4):
        rows = np.flatnonzero(sizes == size)
        found.append(starts[rows, None] + np.where(np.arange(4) < size, np.arange(4), 0))
        found[-1][:, size:] = -1
        row.append(rows)
    for large in np.flatnonzero(sizes > 4):
        ring = points[starts[large] : starts[large] + sizes[large]]
        triangles, finite = np.zeros((0, 3), np.int64), np.isfinite(ring).all()
        if finite:
            triangles, difference = triangulate(ring)
            if difference > CROSSING or (len(triangles) == 0 and _spread(ring) > CROSSING):
                crossed.append(int(large))
        # one without area or with bad numbers stays as one triangle, to be reported like others
        triangles = (triangles if len(triangles) else np.array([(0, 0, 0) if finite else (0, 1, 2)])) + starts[large]
        found.append(np.column_stack([triangles, np.full(len(triangles), -1)]))
        row.append(np.full(len(triangles), large))
    return np.concatenate(found)[np.argsort(np.concatenate(row), kind="stable")]


def warn_of_crossing(source, crossed: dict[str, list[int]]) -> None:
    """Tell once of polygons whose outline crosses itself: their numbers (from 0) by surface."""
    found = []
    for name, rows in crossed.items():
        more = f" and {len(rows) - 1} more" if len(rows) > 1 else ""
        found += [f"{name} (face {rows[0]}{more})"] if rows else []
    if found:
        text = "faces whose outline crosses itself are cut into triangles that may be other ones than meant"
        warn(f"{source}: {text}: {shown(found)}")


def turned(faces: np.ndarray) -> np.ndarray:
    """Faces, (m, 3 or 4), with their corners in the opposite order: their fronts look to where their backs did."""
    if faces.shape[1] == 3:
        return faces[:, ::-1]
    return np.where(faces[:, [3]] < 0, faces[:, [2, 1, 0, 3]], faces[:, ::-1])


def _spread(ring: np.ndarray) -> float:
    """Area of the triangles about a polygon's first corner, whichever way they turn, over the square of its size."""
    spokes = ring[1:] - ring[0]
    return float(np.linalg.norm(np.cross(spokes[:-1], spokes[1:]), axis=1).sum() / max(np.abs(spokes).max() ** 2, 1e-300))
