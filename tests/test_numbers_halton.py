"""Halton numbers, plain and scrambled, against scipy and whole numbers."""

import numpy as np
import pytest
from scipy import stats
from test_numbers import points

from radiosity.sampling.numbers import DIMENSIONS


def test_halton_is_scipys():
    exact = stats.qmc.Halton(DIMENSIONS, scramble=False).random(5000)
    assert np.abs(points("halton", np.arange(5000), zero=True) - exact).max() < 2e-7


def mirrored(index: int, base: int, digits) -> float:
    """Digits of an index, permuted and mirrored at the point, in whole numbers up to the last division."""
    value, scale = 0, 1
    while index:
        value, scale, index = value * base + digits[index % base], scale * base, index // base
    return value / scale


@pytest.mark.parametrize("name", ["halton", "scrambled-halton"])
def test_halton_at_any_index(name):
    """Faure's permutations of 1992, from other programs' tables for bases 5 and 7."""
    orders = [range(2), range(3), (0, 3, 2, 1, 4), (0, 2, 5, 3, 1, 4, 6), (0, 7, 4, 2, 9, 5, 1, 8, 6, 3, 10)]
    index = np.r_[1:3000, np.random.default_rng(3).integers(1, 2**32, 3000), 2**31 - 1, 2**32 - 1]
    for column, base, order in zip(points(name, index, zero=True).T, (2, 3, 5, 7, 11), orders, strict=True):
        exact = [mirrored(i, base, range(base) if name == "halton" else order) for i in index.tolist()]
        error = np.abs(exact - column)
        assert np.minimum(error, 1 - error).max() < 2e-7  # a number next to one may become zero, as under a shift


def test_halton_digits_are_exact_wherever_quotients_are_rounded():
    """All indices of a first pass in base 11: their numbers are whole multiples of 11^-6, each once."""
    x = points("halton", np.arange(11**6), zero=True)[:, 4]
    assert np.array_equal(np.sort(np.rint(x * 11.0**6)), np.arange(11**6))
