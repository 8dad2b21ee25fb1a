"""The sizes of faces, found piece by piece: coordinates are taken axis by axis, in which NumPy is quickest."""

from dataclasses import dataclass

import numpy as np

from ..pieces import of_pieces
from .precision import weighted_median

Vectors = list[np.ndarray]  # coordinates along each axis, (n,) each


@dataclass(frozen=True, eq=False)
class Measures:
    """The sizes of a scene's faces.

    Attributes:
        area: (n_faces,) m², of one side.
        height: (n_faces,) metres, twice the area over the longest of three edges (of a parallelogram: the ends of two edges).
        longest: metres, the longest edge of all.
        bounds: (2, 3) metres, the lowest and highest coordinates.
        centre: (3,) metres, the area-weighted median of centroids, axis by axis; the middle of the box without area.
    """

    area: np.ndarray
    height: np.ndarray
    longest: float
    bounds: np.ndarray
    centre: np.ndarray


def measured(vertices: np.ndarray, faces: np.ndarray) -> Measures:
    """Measure faces, (n_faces, 4), whose last corner is -1 for triangles."""
    axes = [np.ascontiguousarray(vertices[:, axis]) for axis in range(3)]
    area, height = np.empty(len(faces)), np.empty(len(faces))
    centroids = [np.empty(len(faces)) for _ in range(3)]

    def measure(part: slice) -> tuple[list[float], list[float], float]:
        some, quad = faces[part], faces[part, 3] >= 0
        quads = bool(quad.any())
        origin, second = ([axis[some[:, k]] for axis in axes] for k in (0, 1))
        third = [axis[some[:, 2]] for axis in axes]
        last = [axis[np.where(quad, some[:, 3], some[:, 2])] for axis in axes] if quads else third
        along, up = minus(second, origin), minus(last, origin)
        doubled = length(cross(along, up))
        area[part] = doubled * (np.where(quad, 1.0, 0.5) if quads else 0.5)
        longest = np.maximum(np.maximum(length(along), length(up)), length(minus(up, along)))
        height[part] = doubled / np.where(longest > 0, longest, 1)
        for axis in range(3):
            centroids[axis][part] = origin[axis] + (along[axis] + up[axis]) / (np.where(quad, 2.0, 3.0) if quads else 3.0)
        corners = (origin, second, third, last)[: 3 + quads]
        lowest = [min(corner[axis].min() for corner in corners) for axis in range(3)]
        return lowest, [max(corner[axis].max() for corner in corners) for axis in range(3)], float(longest.max())

    lowest, highest, longest = zip(*of_pieces(measure, len(faces)), strict=True)
    bounds = np.stack([np.min(lowest, axis=0), np.max(highest, axis=0)])
    some = area.sum() > 0
    centre = np.array([weighted_median(values, area) for values in centroids]) if some else bounds.mean(axis=0)
    return Measures(area, height, max(longest), bounds, centre)


def minus(one: Vectors, two: Vectors) -> Vectors:
    """Return differences of vectors."""
    return [a - b for a, b in zip(one, two, strict=True)]


def cross(one: Vectors, two: Vectors) -> Vectors:
    """Return cross products."""
    return [one[(i + 1) % 3] * two[(i + 2) % 3] - one[(i + 2) % 3] * two[(i + 1) % 3] for i in range(3)]


def length(vectors: Vectors) -> np.ndarray:
    """Return the lengths of vectors, (n,)."""
    x, y, z = vectors
    return np.sqrt(x * x + y * y + z * z)
