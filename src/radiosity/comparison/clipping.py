"""Intersections of many pairs of convex polygons at once.

A stack of polygons is an array (m, k, 2): counterclockwise corners, the last one repeated where a polygon has fewer than k.
"""

import numpy as np

SAME = 1e-12  # of a polygon's size: corners nearer to each other are one


def areas(polygons: np.ndarray) -> np.ndarray:
    """Return the areas of a stack of polygons, (m,)."""
    local = polygons - polygons[:, :1]
    after = np.roll(local, -1, axis=1)
    return 0.5 * (local[..., 0] * after[..., 1] - local[..., 1] * after[..., 0]).sum(axis=1)


def intersections(ones: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return what the polygons of two stacks have in common, pair by pair, (m, k, 2); all corners are one where that is nothing.

    Each edge of the other polygon cuts off what lies to its right (I. E. Sutherland and G. W. Hodgman, "Reentrant polygon
    clipping", Communications of the ACM 17, 1974).
    """
    result = ones
    for edge in range(others.shape[1]):
        start, end = others[:, edge], others[:, (edge + 1) % others.shape[1]]
        result = _left_of(result, start, end - start)
    return result


def _left_of(polygons: np.ndarray, start: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Return the parts of polygons to the left of lines, (m, k + 1, 2)."""
    offset = polygons - start[:, None]
    height = along[:, None, 0] * offset[..., 1] - along[:, None, 1] * offset[..., 0]
    after, height_after = np.roll(polygons, -1, axis=1), np.roll(height, -1, axis=1)
    crosses = ((height > 0) & (height_after < 0)) | ((height < 0) & (height_after > 0))
    share = np.divide(height, height - height_after, out=np.zeros_like(height), where=crosses)
    meeting = polygons + share[..., None] * (after - polygons)
    m, k, _ = polygons.shape
    corners = np.stack([polygons, meeting], axis=2).reshape(m, 2 * k, 2)
    keep = np.stack([height >= 0, crosses], axis=2).reshape(m, 2 * k)
    return packed(corners, keep)[:, : k + 1]


def packed(corners: np.ndarray, keep: np.ndarray) -> np.ndarray:
    """Return polygons of those corners that are kept, (m, k, 2), the last one repeated."""
    number = keep.sum(axis=1)
    order = np.argsort(~keep, axis=1, kind="stable")
    place = np.minimum(np.arange(keep.shape[1]), np.maximum(number - 1, 0)[:, None])
    return np.take_along_axis(corners, np.take_along_axis(order, place, axis=1)[..., None], axis=1)


def parts(polygons: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return triangles and parallelograms that make up polygons, (n, 4, 2) with the last corner of triangles repeated, and the
    polygon of each, (n,). Polygons without area have none."""
    size = np.ptp(polygons, axis=1).max(axis=1)
    whole = _are_parallelograms(polygons, size)
    found, owner = [polygons[whole, :4]], [np.flatnonzero(whole)]
    rest = np.flatnonzero(~whole)
    polygons = _without_flat_corners(polygons[rest], SAME * size[rest])
    whole = _are_parallelograms(polygons, size[rest])
    found.append(polygons[whole, :4])
    owner.append(rest[whole])
    number = 1 + (np.abs(np.diff(polygons, axis=1)).max(axis=2) > 0).sum(axis=1)
    for corner in range(1, polygons.shape[1] - 1):  # a fan about the first corner
        rows = np.flatnonzero(~whole & (number > corner + 1))
        found.append(polygons[rows][:, [0, corner, corner + 1, corner + 1]])
        owner.append(rest[rows])
    pieces, owners = np.concatenate(found), np.concatenate(owner)
    some = areas(pieces) > 1e-3 * SAME * size[owners] ** 2
    return pieces[some], owners[some]


def _are_parallelograms(polygons: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Return which polygons are parallelograms by their first four corners, (m,) bool."""
    four = polygons[:, :4]
    twist = np.abs(four[:, 0] - four[:, 1] + four[:, 2] - four[:, 3]).max(axis=1)
    same = np.abs(areas(four) - areas(polygons)) <= 1e-9 * areas(polygons)
    return same & (twist <= 1e-9 * size)


def _without_flat_corners(polygons: np.ndarray, least: np.ndarray) -> np.ndarray:
    """Return polygons without corners that repeat the one before, or lie on a straight line with those beside them."""
    apart = np.hypot(*np.moveaxis(polygons - np.roll(polygons, 1, axis=1), 2, 0)) > least[:, None]
    apart[:, 0] |= ~apart.any(axis=1)
    polygons = packed(polygons, apart)
    number = apart.sum(axis=1)[:, None]
    here = np.arange(polygons.shape[1])
    before = np.take_along_axis(polygons, np.where(here == 0, number - 1, here - 1)[..., None], axis=1) - polygons
    after = np.take_along_axis(polygons, np.where(here + 1 >= number, 0, here + 1)[..., None], axis=1) - polygons
    cross = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    bent = cross > 1e-9 * np.hypot(*np.moveaxis(before, 2, 0)) * np.hypot(*np.moveaxis(after, 2, 0))
    return packed(polygons, bent & (here < number))
