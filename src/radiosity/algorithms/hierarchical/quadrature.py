"""Points and weights on parallelograms and triangles, in the coordinates that `patches.elements.points` takes."""

from dataclasses import dataclass
from functools import cache

import numpy as np

INSET = 0.05  # share of a side: distance of corner samples from the corners, away from polygons that touch the element there


@dataclass(frozen=True, eq=False)
class Rule:
    """A quadrature rule.

    Attributes:
    square, half: (q, 2) points of a parallelogram and of a triangle.
    square_weights, half_weights: (q,) weights with a sum of 1.
    """

    square: np.ndarray
    half: np.ndarray
    square_weights: np.ndarray
    half_weights: np.ndarray


@cache
def gauss(order: int) -> Rule:
    """Return Gauss-Legendre points, ``order`` along each direction.

    On triangles it is the conical product (A. H. Stroud, "Approximate calculation of multiple integrals", 1971).
    """
    x, w = np.polynomial.legendre.leggauss(order)
    x, w = (x + 1) / 2, w / 2
    s, t = (grid.ravel() for grid in np.meshgrid(x, x, indexing="ij"))
    weights = np.outer(w, w).ravel()
    drawn = weights * (1 - s)
    return Rule(np.column_stack([s, t]), np.column_stack([s, t * (1 - s)]), weights, drawn / drawn.sum())


@cache
def extremes() -> tuple[np.ndarray, np.ndarray]:
    """Return the points at which values over an element are compared, (5, 2) each: corners, a little inwards, and middle."""
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]])
    third = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0.5], [1 / 3, 1 / 3]])
    return INSET + (1 - 2 * INSET) * corners, INSET + (1 - 3 * INSET) * third
