"""Niederreiter's points in base 2 (H. Niederreiter, "Low-discrepancy and low-dispersion sequences", J. Number Theory 30, 1988).

Row Q e + u of the matrix of an irreducible polynomial p of degree e holds the Laurent coefficients, u places on, of g / p^(Q+1).
They obey the linear recursion of p^(Q+1); its first values, which choose g, are those of P. Bratley, B. L. Fox and
H. Niederreiter, "Implementation and tests of low-discrepancy sequences", ACM TOMACS 2, 1992, section 3.3: e Q zeros, then ones.
"""

import numpy as np

from .base import DIMENSIONS
from .binary import DIGITS, Binary

POLYNOMIALS = (0b10, 0b11, 0b111, 0b1011, 0b1101)  # x, x + 1, x^2 + x + 1, x^3 + x + 1, x^3 + x^2 + 1


def niederreiter() -> Binary:
    """Return the sequence in the order of its definition; other programs order each block of 2^m points by a Gray code."""
    return Binary(matrices)


def matrices() -> np.ndarray:
    """Return the matrices, (5, 32, 32), see `Binary`."""
    result = np.zeros((DIMENSIONS, DIGITS, DIGITS), np.uint8)
    for d, polynomial in enumerate(POLYNOMIALS):
        degree, power = polynomial.bit_length() - 1, 1
        for first in range(0, DIGITS, degree):
            power = _times(power, polynomial)
            values = _recursion(power, first, DIGITS + degree)
            for u in range(min(degree, DIGITS - first)):
                result[d, first + u] = values[u : u + DIGITS]
    return result


def _recursion(polynomial: int, zeros: int, count: int) -> list[int]:
    """Return a sequence that obeys the recursion of a polynomial (bit k is the coefficient of x^k).

    It begins with ``zeros`` zeros, then ones.
    """
    length = polynomial.bit_length() - 1
    values = [0] * zeros + [1] * (length - zeros)
    while len(values) < count:
        last = values[-length:]
        values.append(sum(last[k] for k in range(length) if (polynomial >> k) & 1) % 2)
    return values


def _times(a: int, b: int) -> int:
    """Return the product of polynomials modulo 2."""
    product = 0
    while b:
        product ^= a * (b & 1)
        a, b = a << 1, b >> 1
    return product
