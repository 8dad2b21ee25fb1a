"""Sobol' points (I. M. Sobol', USSR Computational Mathematics and Mathematical Physics 7(4), 1967) with the direction numbers of
S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci. Comput. 30, 2008
(file new-joe-kuo-6.21201)."""

import numpy as np

from .base import DIMENSIONS
from .binary import DIGITS, Binary

# dimensions 2 to 5: degree s of the primitive polynomial, its inner coefficients a, and the first direction integers m
DIRECTIONS = ((1, 0, (1,)), (2, 1, (1, 3)), (3, 1, (1, 3, 1)), (3, 2, (1, 1, 1)))


def sobol() -> Binary:
    """Return the sequence in the order of its definition; other programs order each block of 2^m points by a Gray code."""
    return Binary(matrices)


def matrices() -> np.ndarray:
    """Return the matrices, (5, 32, 32), see `Binary`."""
    result = np.zeros((DIMENSIONS, DIGITS, DIGITS), np.uint8)
    result[0] = np.eye(DIGITS)
    for d, (degree, inner, first) in enumerate(DIRECTIONS, start=1):
        m = list(first)
        for k in range(degree, DIGITS):
            value = m[k - degree] ^ (m[k - degree] << degree)
            for i in range(1, degree):
                value ^= ((inner >> (degree - 1 - i)) & 1) * (m[k - i] << i)
            m.append(value)
        for column, value in enumerate(m):  # the direction number is m_k / 2^k
            for row in range(column + 1):
                result[d, row, column] = (value >> (column - row)) & 1
    return result
