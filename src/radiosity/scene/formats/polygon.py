"""Triangles of a flat polygon: concave, or with holes that seams (edges run both ways) join to its outline."""

from itertools import pairwise

import numpy as np

ROUNDING = 1e-9  # relative difference of areas that is none


def vector_area(points: np.ndarray) -> np.ndarray:
    """Return area times normal of a closed polygon, (3,); points, (n, 3), are counterclockwise seen from the normal's side."""
    spokes = points[1:] - points[0]
    return np.cross(spokes[:-1], spokes[1:]).sum(axis=0) / 2


def triangulate(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Corners of triangles that fill a polygon, facing as it does.

    The polygon is cut as its projection on the plane of its mean normal; corners stay where they are.

    Args:
        points: (n, 3), n at least 3.

    Returns:
        (m, 3) int64 indices into ``points``, and the relative difference between the areas of the triangles and of the
        polygon: 0 but for rounding unless its outline crosses itself. No triangles where it has no area.
    """
    normal = vector_area(points)
    area = np.linalg.norm(normal)
    reach = np.abs(points - points[0]).max()
    if not area > 1e-14 * reach**2:
        return np.zeros((0, 3), np.int64), 0.0
    flat = _projected(points, normal) / reach
    ring = np.arange(len(points))
    best = _cut(flat, [ring], area / reach**2)
    # a seam may run across its own hole: then the hole must be told apart from the outline
    if best[1] > ROUNDING and len(loops := _loops(ring, np.unique(points, axis=0, return_inverse=True)[1].ravel())) > 1:
        size = [abs(_signed(flat[loop])) for loop in loops]
        loops = [loops[i] for i in np.argsort(size)[::-1]]
        best = min(best, _cut(flat, loops, area / reach**2), key=lambda found: found[1])
    return best


def pierced(outline: np.ndarray, holes: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, float]:
    """Triangles of a flat polygon with holes that are given apart; they may run either way, and touch its edges.

    Returns:
        (n, 3) corners, (m, 3) int64 triangles, facing as the outline does, and how far their area is from that of the outline
        less that of the holes, relative to the outline's: 0 but for rounding unless holes overlap, or reach out of it.
    """
    points = np.concatenate([outline, *holes])
    normal = vector_area(outline)
    whole = float(np.linalg.norm(normal))
    reach = np.abs(points - points[0]).max()
    if not whole > 1e-14 * reach**2:
        return points, np.zeros((0, 3), np.int64), 0.0
    flat = _projected(points, normal) / reach
    ends = np.cumsum([0, len(outline), *map(len, holes)])
    loops = [np.arange(start, end) for start, end in pairwise(ends)]
    area = whole / reach**2 - sum(abs(_signed(flat[loop])) for loop in loops[1:])
    if abs(area) * reach**2 <= ROUNDING * whole:
        return points, np.zeros((0, 3), np.int64), 0.0
    triangles, difference = _cut(flat, loops, area)
    return points, triangles, abs(difference * area) * reach**2 / whole


def _projected(points: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Coordinates in the plane of a normal, (n, 2), from the first point; counterclockwise stays so."""
    axes = np.linalg.svd(normal[None])[2]  # normal first, up to sign
    turn = np.sign(np.linalg.det(axes) * (axes[0] @ normal))
    return (points - points[0]) @ axes[1:].T * (1, turn)


def _cut(flat: np.ndarray, loops: list[np.ndarray], area: float) -> tuple[np.ndarray, float]:
    """Triangles between an outline, the first of the loops, and its holes; and how far their area is from ``area``."""
    from mapbox_earcut import triangulate_float64

    order = np.concatenate(loops)
    ends = np.cumsum([len(loop) for loop in loops]).astype(np.uint32)
    corners = order[triangulate_float64(np.ascontiguousarray(flat[order]), ends).reshape(-1, 3).astype(np.int64)]
    one, two, three = (flat[corners[:, i]] for i in range(3))
    signed = ((two - one)[:, 0] * (three - one)[:, 1] - (two - one)[:, 1] * (three - one)[:, 0]) / 2
    corners[signed < 0] = corners[signed < 0][:, ::-1]
    return corners, abs(float(np.abs(signed).sum()) / area - 1)


def _loops(ring: np.ndarray, place: np.ndarray) -> list[np.ndarray]:
    """The closed loops that are left of a ring without its seams; corners of equal ``place`` coincide."""
    todo, done = [ring], []
    while todo:
        ring = todo.pop()
        at = place[ring]
        edges = {edge: i for i, edge in enumerate(zip(at, np.roll(at, -1), strict=True))}
        there, back = next(((i, edges[b, a]) for (a, b), i in edges.items() if edges.get((b, a), -1) > i), (-1, -1))
        if there < 0:
            done.append(ring)
        else:
            parts = np.concatenate([ring[: there + 1], ring[back + 2 :]]), ring[there + 1 : back]
            todo += [part for part in parts if len(part) >= 3]
    return done


def _signed(flat: np.ndarray) -> float:
    """Area of a plane polygon, negative where it turns clockwise."""
    x, y = flat.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
