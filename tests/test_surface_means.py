"""Means over surfaces of many patches: points that depend on the patch give them a small part of the error of random numbers.

A wall of a black cube lights the others, so their mean irradiance is the form factor, in closed form. Of N random lines a
share F lands with a relative error of sqrt((1 - F) / (F N)), which is what the measured errors are held against. (Random numbers
have 0.88 of that here, over 32 seeds: how many lines a patch fires is not random.)
"""

import numpy as np
import pytest
from enclosures import cube, cube_irradiance
from scipy import stats

import radiosity as rd
from radiosity.sampling.numbers import NUMBERS
from radiosity.tracing import line_tracer

RAYS, SEEDS = 200_000, 8
HALF = 0.44  # of what random numbers have


@pytest.fixture(scope="module")
def patches():
    """2 400 of them."""
    return rd.subdivide(cube(0.0, np.eye(6)[0][:, None]), cells=20)


def share_of_random(patches, method: str = "random-walk", **choices) -> float:
    """RMS over walls and seeds of the error of their means, over that of as many random lines."""
    exact = cube_irradiance(np.zeros(6), np.eye(6)[0])[1:]
    squares = []
    for seed in range(SEEDS):
        solution = rd.solve(patches, method, rays=RAYS, seed=seed, **choices)
        means = solution.irradiance[:, 0].reshape(6, -1).mean(axis=1)[1:]
        squares.append((means / exact - 1) ** 2 * solution.rays * exact / (1 - exact))
    return float(np.sqrt(np.mean(squares)))


@pytest.mark.parametrize("numbers", [name for name in NUMBERS if name != "random"])
def test_means_err_half_as_much_as_with_random_numbers(patches, numbers):
    assert share_of_random(patches, numbers=numbers) < HALF


@pytest.mark.parametrize("method", ["particle-tracing", "stochastic-ray", "stochastic-jacobi-incremental"])
def test_so_do_those_of_other_methods_that_fire_from_patches(patches, method):
    assert share_of_random(patches, method) < HALF


def test_one_shift_for_all_patches_errs_more_than_random_numbers(patches):
    """What the tests above have to tell: 60 lines a patch are 60 directions of a whole wall."""
    assert share_of_random(patches, randomisation="shared") > 1


def test_random_numbers_err_like_random_numbers(patches):
    """40 squares of walls and seeds, 32 of which are independent, since walls of a seed share its lines: a chance of 1e-3."""
    low, high = np.sqrt(stats.chi2.ppf([5e-4, 1 - 5e-4], 32) / 32)
    assert low < share_of_random(patches, numbers="random") / 0.88 < high


def test_beyond_its_own_lines_a_patch_takes_the_shift_of_all(monkeypatch):
    """A run of few patches ends in the bits of a shared shift where patches have no lines of their own, and not else."""
    patches = rd.subdivide(cube(), cells=1)
    assert line_tracer.own_lines(6) == 16

    def arrivals(**choices):
        return rd.solve(patches, "random-walk", quanta=3000, replicates=2, **choices).state["arrivals"]

    shared = arrivals(randomisation="shared")
    assert not np.array_equal(arrivals(), shared)
    monkeypatch.setattr(line_tracer, "own_lines", lambda n: 1)
    assert not np.array_equal(arrivals(), shared)
    monkeypatch.setattr(line_tracer, "own_lines", lambda n: 0)
    assert np.array_equal(arrivals(), shared)


def test_how_many_lines_of_a_patch_are_its_own():
    for n in (1, 2, 3, 70, 2400, 150_000):
        own = line_tracer.own_lines(n)
        assert 2 * n < own <= 4 * n
        assert own & (own - 1) == 0
    assert line_tracer.own_lines(2**31) == 2**32 - 1
