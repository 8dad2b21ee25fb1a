"""Generator matrices of base 2, against the theory of polynomials that they come from."""

from math import comb

import numpy as np

from radiosity.sampling.numbers import niederreiter, sobol


def times(a: int, b: int) -> int:
    """Product modulo 2 of polynomials, or of the first coefficients of series."""
    return sum_xor(a << k for k in range(b.bit_length()) if b >> k & 1)


def sum_xor(values) -> int:
    total = 0
    for value in values:
        total ^= value
    return total


def remainder(a: int, b: int) -> int:
    while a.bit_length() >= b.bit_length():
        a ^= b << (a.bit_length() - b.bit_length())
    return a


def gcd(a: int, b: int) -> int:
    while b:
        a, b = b, remainder(a, b)
    return a


def test_niederreiters_rows_are_laurent_series_as_his_theorem_asks():
    """A row times p^(Q + 1) is a polynomial g: nothing is left below x^0. And g has no factor p."""
    for d, p in enumerate((0b10, 0b11, 0b111, 0b1011, 0b1101)):
        degree, first = p.bit_length() - 1, 1
        rows = niederreiter.matrices()[d].tolist()
        for row, values in enumerate(rows):
            series = int("".join(map(str, values)), 2)  # bit 31 is the coefficient of x^-1
            power = 1
            for _ in range(row // degree + 1):
                power = times(power, p)
            length = power.bit_length() - 1
            if length > 24:
                continue  # too few coefficients are left to look at
            product = times(series, power)
            assert (product >> length) % 2 ** (32 - length) == 0  # what the cut of the series does not reach
            g = product >> 32
            assert gcd(g, p) == 1
            if row % degree == 0:
                first = g
            assert g == remainder(first << row % degree, power)


def test_niederreiter_and_sobol_begin_alike():
    """x gives the identity, x + 1 Pascal's matrix modulo 2."""
    rows = np.arange(32)
    pascal = np.array([[comb(c, r) % 2 for c in rows] for r in rows])
    for matrices in (niederreiter.matrices(), sobol.matrices()):
        assert np.array_equal(matrices[0], np.eye(32))
        assert np.array_equal(matrices[1], pascal)
