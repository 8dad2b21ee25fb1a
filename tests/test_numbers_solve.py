"""Every sequence solves the furnace, with honest error bars, and ends in equal integers in every order."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.sampling.numbers import NUMBERS


@pytest.fixture(scope="module")
def patches():
    return rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1)


@pytest.mark.parametrize("numbers", NUMBERS)
def test_furnace_is_one_everywhere(patches, numbers):
    """Errors in units of their standard error: Student with 15 degrees of freedom has a root mean square of 1.07."""
    squares = []
    for seed in range(4):
        solution = rd.solve(patches, rays=500_000, replicates=16, numbers=numbers, seed=seed)
        difference = solution.radiosity - 1
        assert np.sqrt(np.average(difference[:, 0] ** 2, weights=patches.area)) < (0.02 if numbers == "random" else 0.008)
        assert solution.escaped[0] == 0
        squares.append((difference / solution.standard_error) ** 2)
    assert np.max(squares) < 8**2  # the largest of 4 * 70: p = 280 * 1e-6
    assert 0.75 < np.sqrt(np.mean(squares)) < 1.4  # patches share a sequence, hence much of their errors


@pytest.mark.parametrize("numbers", NUMBERS)
def test_orders_end_in_equal_integers(patches, numbers):
    """Depth-first asks for points inside a loop that is recorded, breadth-first in kernels of every step of the index."""
    one, two = (
        rd.solve(patches, quanta=40_000, replicates=3, seed=5, numbers=numbers, order=order).state
        for order in ("depth-first", "breadth-first")
    )
    for name in ("arrivals", "fired", "missed"):
        assert np.array_equal(one[name], two[name])
