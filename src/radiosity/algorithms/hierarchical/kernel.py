"""Form factors of pairs of elements without obstacles, and how much they vary over the receiver.

The factor of near pairs is exact (`factors.exchange`): a lamp a centimetre below a ceiling is seen by a small part of a patch,
which a few points would miss. For other pairs, the factor from a point to a polygon is exact (`factors.from_points`), so
quadrature is needed over one element only. The smaller element is taken, over which the factor varies less, and the other
direction follows from A_r F_rs = A_s F_sr.
"""

from dataclasses import dataclass

import numpy as np

from ...factors.polygons import exchange, from_points
from ...patches import Hierarchy, elements
from .quadrature import extremes, gauss

POINTS = 2  # quadrature points along each direction
GAP = 3.0  # pairs closer than 3 radii of the smaller element are near
PLANE = 1e-9  # share of a scene's size: points closer to a plane are in it


@dataclass(frozen=True, eq=False)
class Shapes:
    """Elements as polygons.

    Attributes:
        element: (m,) int64.
        corners: (m, 4, 3) float64, metres.
        normal: (m, 3) float64.
        centroid: (m, 3) float64, metres.
        area, radius: (m,) float64, m² and metres.
    """

    element: np.ndarray
    corners: np.ndarray
    normal: np.ndarray
    centroid: np.ndarray
    area: np.ndarray
    radius: np.ndarray

    @staticmethod
    def of(hierarchy: Hierarchy, element: np.ndarray) -> "Shapes":
        corners, centroid = elements.corners(hierarchy, element), elements.centroid(hierarchy, element)
        radius = np.linalg.norm(corners - centroid[:, None], axis=2).max(axis=1)
        return Shapes(element, corners, elements.normal(hierarchy, element), centroid, elements.area(hierarchy, element), radius)

    def take(self, rows: np.ndarray) -> "Shapes":
        """Return some of the shapes (indices or mask)."""
        return Shapes(*(value[rows] for value in vars(self).values()))

    def in_front(self, other: "Shapes", tolerance: float) -> np.ndarray:
        """Return which corners of another element lie in front of this one's plane, (m, 4) bool."""
        return np.einsum("mki,mi->mk", other.corners - self.centroid[:, None], self.normal) > tolerance


def facing(hierarchy: Hierarchy, one: Shapes, other: Shapes) -> tuple[np.ndarray, np.ndarray]:
    """Return whether some part of each lies in front of the other's plane, and whether all of each does, (m,) bool each."""
    low, high = hierarchy.patches.scene.bounds
    tolerance = PLANE * float((high - low).max())
    corners = np.stack([one.in_front(other, tolerance), other.in_front(one, tolerance)])
    return np.all(np.any(corners, axis=2), axis=0), np.all(corners, axis=(0, 2))


def unoccluded(hierarchy: Hierarchy, receiver: Shapes, source: Shapes) -> np.ndarray:
    """Return F_rs, the share of what leaves the receiver that arrives at the source, without obstacles, (m,) float64."""
    swap = source.area < receiver.area * (1 - 1e-9)
    gap = np.linalg.norm(receiver.centroid - source.centroid, axis=1) - np.maximum(receiver.radius, source.radius)
    near = gap < GAP * np.minimum(receiver.radius, source.radius)
    factor = np.zeros(len(swap))
    for swapped in (False, True):
        here, there = (source, receiver) if swapped else (receiver, source)
        rows = np.flatnonzero((swap == swapped) & ~near)
        if len(rows):
            factor[rows] = _mean(hierarchy, here.take(rows), there.take(rows), POINTS)
    factor = np.where(swap, factor * source.area / receiver.area, factor)
    factor[near] = exchange(receiver.corners[near], source.corners[near]) / receiver.area[near]
    return factor


def samples(hierarchy: Hierarchy, receiver: Shapes, source: Shapes) -> np.ndarray:
    """Return the factor from the receiver's corners and middle to the source, (m, 5) float64."""
    return _at(hierarchy, receiver, source, *extremes())


def _mean(hierarchy: Hierarchy, here: Shapes, there: Shapes, order: int) -> np.ndarray:
    rule = gauss(order)
    quad = elements.is_quad(hierarchy, here.element)[:, None]
    return (_at(hierarchy, here, there, rule.square, rule.half) * np.where(quad, rule.square_weights, rule.half_weights)).sum(
        axis=1
    )


def _at(hierarchy: Hierarchy, here: Shapes, there: Shapes, square: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Return the factors from points of elements to other elements, (m, q)."""
    points = elements.points(hierarchy, here.element, square, half)
    count = points.shape[1]
    values = from_points(points.reshape(-1, 3), np.repeat(here.normal, count, axis=0), np.repeat(there.corners, count, axis=0))
    return values.reshape(-1, count)
