"""Gauss rules over parallelograms and triangles, as places along both edges."""

from functools import cache

import numpy as np


@cache
def rule(order: int, *, triangle: bool) -> np.ndarray:
    """Return shares along the first and the second edge, and weights that sum to one, (order², 3); of degree 2 order - 1.

    A triangle's rule is that of a square of which one side is drawn together (A. H. Stroud, "Approximate calculation of multiple
    integrals", 1971): its first share has the weight 1 - s of Gauss and Jacobi.
    """
    nodes, weights = (x / 2 for x in np.polynomial.legendre.leggauss(order))
    nodes = nodes + 0.5
    if not triangle:
        s, t = np.meshgrid(nodes, nodes, indexing="ij")
        return np.stack([s.ravel(), t.ravel(), np.outer(weights, weights).ravel()], axis=1)
    places, shares = _jacobi(order)
    s, t = np.repeat(places, order), np.tile(nodes, order)
    return np.stack([s, (1 - s) * t, np.outer(shares, weights).ravel()], axis=1)


def _jacobi(order: int) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes in [0, 1] and weights, which sum to one, for the weight function 2 (1 - s).

    G. H. Golub and J. H. Welsch, "Calculation of Gauss quadrature rules", Mathematics of Computation 23, 1969.
    """
    k = np.arange(order)
    diagonal = -1 / ((2 * k + 1) * (2 * k + 3.0))
    k = k[1:]
    beside = np.sqrt(k * (k + 1) / ((2 * k + 1) ** 2.0))
    values, vectors = np.linalg.eigh(np.diag(diagonal) + np.diag(beside, 1) + np.diag(beside, -1))
    return (values + 1) / 2, vectors[0] ** 2
