"""The sizes of faces, found piece by piece: coordinates are taken axis by axis, in which NumPy is quickest."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..pieces import of_pieces
from .precision import weighted_median

SIZE = 1 << 14  # faces of a piece: what is known of them stays in the cache
Vectors = list[np.ndarray]  # coordinates along each axis, (n,) each
Also = Callable[[slice, Vectors, np.ndarray], None]  # takes some faces, the cross products of two edges, and `largest_squared`


@dataclass(frozen=True, eq=False)
class Measures:
    """The sizes of a scene's faces.

    Attributes:
        area: (n_faces,) m², of one side.
        longest: metres, the longest edge of all (of parallelograms, and the ends of two edges).
        least_doubled: m², the least of what `heights` divides: twice the area of a triangle, the area of a parallelogram.
        least_height: metres, the least of `heights`.
        bounds: (2, 3) metres, the lowest and highest coordinates.
    """

    area: np.ndarray
    longest: float
    least_doubled: float
    least_height: float
    bounds: np.ndarray


def measured(vertices: np.ndarray, faces: np.ndarray, also: Also | None = None) -> Measures:
    """Measure faces, (n_faces, 4), whose last corner is -1 for triangles; each piece of them goes to ``also``, too."""
    axes = [np.ascontiguousarray(vertices[:, axis]) for axis in range(3)]
    area = np.empty(len(faces))

    def measure(part: slice) -> tuple[list[float], list[float], float, float, float]:
        corners, quad = _corners(axes, faces[part])
        lowest = [min(corner[axis].min() for corner in corners) for axis in range(3)]
        highest = [max(corner[axis].max() for corner in corners) for axis in range(3)]
        normal, squared = _normal_and_squared(corners)
        if also is not None:
            also(part, normal, squared)
        doubled, longest = length(normal), np.sqrt(squared, out=squared)
        area[part] = doubled * (0.5 if quad is None else np.where(quad, 1.0, 0.5))
        return lowest, highest, float(longest.max()), float(doubled.min()), float(_height(doubled, longest).min())

    lowest, highest, longest, doubled, height = zip(*of_pieces(measure, len(faces), SIZE), strict=True)
    bounds = np.stack([np.min(lowest, axis=0), np.max(highest, axis=0)])
    return Measures(area, max(longest), min(doubled), min(height), bounds)


def heights(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return twice the area over the longest of three edges, metres, (n_faces,); of a parallelogram: the ends of two edges."""
    axes = [np.ascontiguousarray(vertices[:, axis]) for axis in range(3)]

    def some(part: slice) -> np.ndarray:
        normal, squared = _normal_and_squared(_corners(axes, faces[part])[0])
        return _height(length(normal), np.sqrt(squared))

    return np.concatenate(of_pieces(some, len(faces), SIZE))


def median_centre(vertices: np.ndarray, faces: np.ndarray, measures: Measures) -> np.ndarray:
    """Return the area-weighted median of centroids, axis by axis, (3,) metres; the middle of the box without area."""
    if not measures.area.sum() > 0:
        return measures.bounds.mean(axis=0)
    result = np.empty(3)
    for axis in range(3):
        one = [np.ascontiguousarray(vertices[:, axis])]

        def centroid(part: slice, one=one) -> np.ndarray:
            corners, quad = _corners(one, faces[part])
            origin, along, up = corners[0][0], corners[1][0] - corners[0][0], corners[-1][0] - corners[0][0]
            return origin + (along + up) / (3.0 if quad is None else np.where(quad, 2.0, 3.0))

        result[axis] = weighted_median(np.concatenate(of_pieces(centroid, len(faces), SIZE)), measures.area)
    return result


def _corners(axes: Vectors, faces: np.ndarray) -> tuple[list[Vectors], np.ndarray | None]:
    """Return the places of the corners of some faces, three of each or four, and which have four; None where none has.

    Where others have four, triangles repeat the third.
    """
    columns = np.ascontiguousarray(faces.T)
    quad = columns[3] >= 0
    if not quad.any():
        return [[axis.take(column) for axis in axes] for column in columns[:3]], None
    last = np.where(quad, columns[3], columns[2])  # not in place: columns may be the faces themselves
    return [[axis.take(column) for axis in axes] for column in (*columns[:3], last)], quad


def _normal_and_squared(corners: list[Vectors]) -> tuple[Vectors, np.ndarray]:
    """Return the cross products of two edges of faces, and `largest_squared` of these."""
    along, up = minus(corners[1], corners[0]), minus(corners[-1], corners[0])
    return cross(along, up), largest_squared(along, up)


def _height(doubled: np.ndarray, longest: np.ndarray) -> np.ndarray:
    return doubled / np.where(longest > 0, longest, 1)


def largest_squared(along: Vectors, up: Vectors) -> np.ndarray:
    """Return the square of the longest of two edges and the edge between their ends, (n,)."""
    result = np.maximum(_squared(along), _squared(up))
    return np.maximum(result, _squared(minus(up, along)), out=result)


def minus(one: Vectors, two: Vectors) -> Vectors:
    """Return differences of vectors."""
    return [a - b for a, b in zip(one, two, strict=True)]


def cross(one: Vectors, two: Vectors) -> Vectors:
    """Return cross products."""
    return [one[(i + 1) % 3] * two[(i + 2) % 3] - one[(i + 2) % 3] * two[(i + 1) % 3] for i in range(3)]


def length(vectors: Vectors) -> np.ndarray:
    """Return the lengths of vectors, (n,)."""
    result = _squared(vectors)
    return np.sqrt(result, out=result)


def _squared(vectors: Vectors) -> np.ndarray:
    x, y, z = vectors
    result = x * x
    result += y * y
    result += z * z
    return result
