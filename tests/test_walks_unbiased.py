"""Estimators of walks are unbiased: t-tests over 300 independent short runs, in the furnace where B = 1 everywhere.

A run is a replicate of some 150 walks. Every surface is compared, at alpha = 1e-4 for a case together (Bonferroni); with 14 cases
a false alarm has a chance of 0.14 %, and seeds are fixed. Walks that are deliberately wrong fail it.
"""

import numpy as np
import pytest
from methods import critical
from replicates import powers

import radiosity as rd
from radiosity.algorithms.walks.particles import PathSegments

RUNS, WALKS = 300, 150


def largest_difference(walks=WALKS, **choices) -> float:
    """Of surfaces, in standard errors."""
    patches = rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1)
    exact = np.bincount(patches.surface, patches.area)
    power = powers(rd.solve(patches, rd.Method(**choices), quanta=walks, replicates=RUNS, seed=1))
    error = power.std(axis=0, ddof=1) / RUNS**0.5
    assert np.median(error / exact) < 0.03
    return float(np.abs((power.mean(axis=0) - exact) / error).max())


SURFACES = len(rd.load_scene("labyrinth").names)
BOUND = critical(RUNS, SURFACES)
CASES = [
    {"equation": equation, "estimator": estimator, "absorption": "drawn", "numbers": numbers}
    for equation in ("discrete", "continuous")
    for estimator in ("collision", "absorption", "survival")
    for numbers in ("halton", "random")
]
LONGER = [c for c in CASES if c["numbers"] == "halton" and (c["equation"] == "continuous") == (c["estimator"] == "survival")]


@pytest.mark.parametrize(
    "choices",
    [pytest.param(c, marks=pytest.mark.slow) if c in LONGER else c for c in CASES],
    ids=lambda c: "/".join(c.values()),
)
def test_unbiased(choices):
    assert largest_difference(**choices) < BOUND


@pytest.mark.parametrize("equation", ["discrete", "continuous"])
def test_gathering_is_consistent(equation):
    """It divides sums by numbers of lines that hang together: a bias of the order of one walk a patch, which must fall."""
    assert largest_difference(40 * WALKS, equation=equation, estimator="gathering") < BOUND


@pytest.mark.parametrize("equation", ["discrete", "continuous"])
def test_numbers_that_start_anew_at_each_landing_are_rejected(equation, monkeypatch):
    """Later legs that turn as the first one did, from where it landed: the walk is no longer a walk."""
    before = PathSegments._moved

    def wrong(self, numbers, stream):
        moved = before(self, numbers, stream)
        return [numbers[0] * 0 + 0.3, numbers[1] * 0 + 0.5, *moved[2:]] if len(numbers) > 1 else moved

    monkeypatch.setattr(PathSegments, "_moved", wrong)
    assert largest_difference(equation=equation, absorption="drawn") > BOUND
