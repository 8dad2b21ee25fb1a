"""Convex polygons in a plane: cutting them along a line, and into triangles and parallelograms.

All polygons are (k, 2) arrays.
"""

import numpy as np

SAME = 1e-9  # of its size: corners of a parallelogram may be off by this
EQUAL = 1e-9  # widths that differ by less are equal


def width(one: list[float], two: list[float], three: list[float]) -> float:
    """Return the least height of a counterclockwise triangle over its longest edge: 0.87 where all edges are equal."""
    (ax, ay), (bx, by), (cx, cy) = one, two, three
    twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    longest = max((bx - ax) ** 2 + (by - ay) ** 2, (cx - bx) ** 2 + (cy - by) ** 2, (ax - cx) ** 2 + (ay - cy) ** 2)
    return twice / max(longest, 1e-300)


def cut(polygon: np.ndarray, point: np.ndarray, along: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the parts to the left and to the right of a line.

    Args:
        along: of unit length. least: corners nearer to the line than this lie on it. Where all corners of one side do, there is
            nothing to cut: None.
    """
    offset = polygon - point
    height = along[0] * offset[:, 1] - along[1] * offset[:, 0]
    height[np.abs(height) < least] = 0.0
    if height.min() >= 0 or height.max() <= 0:
        return None
    sides: tuple[list, list] = ([], [])
    for i, here in enumerate(height):
        j = (i + 1) % len(height)
        if here >= 0:
            sides[0].append(polygon[i])
        if here <= 0:
            sides[1].append(polygon[i])
        if here * height[j] < 0:
            meeting = polygon[i] + here / (here - height[j]) * (polygon[j] - polygon[i])
            sides[0].append(meeting)
            sides[1].append(meeting)
    return np.array(sides[0]), np.array(sides[1])


def inside(polygon: np.ndarray, one: np.ndarray, two: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the ends of the part of a segment that lies inside; None where it is shorter than ``least``, or on the rim."""
    low, high, along = 0.0, 1.0, two - one
    length = float(np.hypot(*along))
    if length < least:
        return None
    edges = np.concatenate([polygon[1:], polygon[:1]]) - polygon
    (x, y), (dx, dy), sizes = one.tolist(), along.tolist(), np.hypot(edges[:, 0], edges[:, 1]).tolist()
    for (corner_x, corner_y), (edge_x, edge_y), size in zip(polygon.tolist(), edges.tolist(), sizes, strict=True):
        if size == 0:
            continue
        start = (edge_x * (y - corner_y) - edge_y * (x - corner_x)) / size
        slope = (edge_x * dy - edge_y * dx) / size
        if abs(slope) < 1e-12 * length or max(start, start + slope) < least:
            if max(start, start + slope) < least:
                return None
            continue
        at = -start / slope
        low, high = (max(low, at), high) if slope > 0 else (low, min(high, at))
        if (high - low) * length < least:
            return None
    return one + low * along, one + high * along


def parts(polygon: np.ndarray) -> list[np.ndarray]:
    """Return triangles (3, 2) and parallelograms (4, 2) that make up a polygon, none of them thinner than need be.

    Of cuts that are alike but for rounding the first is taken.
    """
    polygon = _without_flat_corners(polygon)
    k = len(polygon)
    if k < 3:
        return []
    if k == 3 or (k == 4 and _is_parallelogram(polygon)):
        return [polygon]
    best, found = -1.0, []
    for i in range(k):
        for j in range(i + 2, k - (i == 0)):
            two = polygon[i : j + 1], np.concatenate([polygon[j:], polygon[: i + 1]])
            quality = min(_quality(part) for part in two)
            if quality > best + EQUAL:
                best, found = quality, two
    return [part for half in found for part in parts(half)]


def _quality(polygon: np.ndarray) -> float:
    """Return how wide the thinnest part of a polygon may be."""
    corners = polygon.tolist()
    if len(corners) == 3:
        return width(*corners)
    if len(corners) == 4 and _is_parallelogram(polygon):
        return 2 * width(*corners[:3])
    return min(width(corners[i - 2], corners[i - 1], corners[i]) for i in range(len(corners)))


def _is_parallelogram(polygon: np.ndarray) -> bool:
    size = np.abs(polygon - polygon[0]).max()
    return bool(np.abs(polygon[0] - polygon[1] + polygon[2] - polygon[3]).max() <= SAME * size)


def _without_flat_corners(polygon: np.ndarray) -> np.ndarray:
    before, after = np.roll(polygon, 1, axis=0) - polygon, np.roll(polygon, -1, axis=0) - polygon
    cross = after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0]
    return polygon[cross > SAME * np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)]
