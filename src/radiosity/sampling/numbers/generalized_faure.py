"""Generalised Faure points in base 5 (S. Tezuka, "Polynomial arithmetic analogue of Halton sequences", ACM TOMACS 3, 1993).

The matrices are L_d U_d, where U_d is the d-th power of Pascal's matrix, as in `faure`. With any lower triangular L_d without
zeros on the diagonal this is a (0, 5)-sequence too: the first rows of the product span the same space as the first rows of U_d.
Here, as in RenderPark, L_d is the transpose of U_d.
"""

import numpy as np

from .base import DIMENSIONS
from .faure import pascal
from .quinary import BASE, ROWS, Quinary


def generalized_faure() -> Quinary:
    """Return the sequence in the order of its definition."""
    return Quinary(matrices)


def matrices() -> np.ndarray:
    """Return the matrices, (5, 12, 15), see `Quinary`."""
    return np.array([(pascal(d).T @ pascal(d) % BASE)[:ROWS] for d in range(DIMENSIONS)], np.uint8)
