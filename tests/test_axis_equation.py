"""Contract of an equation: what every member of `EQUATIONS` must keep, in every process that takes it (`members.plainest`).

On walls that are not cut the equations have different solutions. That of the patches is known exactly (`cube_irradiance`); the
continuous one is that of fine patches, found by the discrete equation on a sixteenth of a wall's edge, so that each member is
compared with something that it had no part in. Power of each wall, mean of 16 replicates, by Student's t at alpha = 1e-4 for all
walls of a test together (`methods.critical`); seeds are fixed.
"""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import cube, cube_irradiance
from members import accepted, each, plainest
from methods import critical
from replicates import powers

import radiosity as rd
from radiosity.algorithms.walks.particles import PathSegments
from radiosity.method.equation import EQUATIONS

REPLICATES, RAYS = 16, 400_000
RHO, LIGHT = np.array([0.3, 0.9, 0.9, 0.9, 0.9, 0.9]), np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
CUT = 16  # the equations differ by 2 to 9 % here
LEAST = {  # what is left out beside noise
    "continuous": 1e-3,  # by cutting into so many: 7e-4, from cells=24
    "discrete": 1e-4,  # of the light, by iterations as they begin (docs/iterations.md)
}


def walls() -> rd.Patches:
    return rd.subdivide(cube(RHO[:, None], LIGHT[:, None]), cells=1)


@pytest.fixture(scope="module")
def exact() -> dict[str, np.ndarray]:
    """(6,) power that each wall receives, by equation."""
    fine = rd.subdivide(cube(RHO[:, None], LIGHT[:, None]), cells=CUT)
    solution = rd.solve(fine, "random-walk", rays=15_000_000)
    return {
        "discrete": cube_irradiance(RHO, LIGHT),
        "continuous": np.bincount(fine.surface, fine.area * solution.irradiance[:, 0]),
    }


def differences(method: rd.Method, exact: dict[str, np.ndarray]) -> dict[str, float]:
    """From each equation's solution the largest one, over the bound that it exceeds with probability alpha if that is solved."""
    power = powers(rd.solve(walls(), method, rays=RAYS, replicates=REPLICATES))
    error = power.std(axis=0, ddof=1) / REPLICATES**0.5
    bounds = {name: critical(REPLICATES, 6) * error + LEAST[name] * expected for name, expected in exact.items()}
    return {name: float((np.abs(power.mean(axis=0) - expected) / bounds[name]).max()) for name, expected in exact.items()}


@pytest.mark.parametrize("equation", EQUATIONS)
def test_some_process_takes_it(equation):
    assert plainest("equation", equation)
    assert EQUATIONS[equation]


@each(plainest, "equation")
class TestContract:
    def test_it_is_solved_and_no_other(self, method, exact):
        assert set(exact) == set(EQUATIONS)
        for equation, found in differences(method, exact).items():
            assert (found < 1) == (equation == method.equation)

    def test_in_the_furnace_all_agree(self, method):
        solution = rd.solve(rd.subdivide(cube(0.5, 1.0), cells=1), method, rays=RAYS, replicates=REPLICATES)
        power = powers(solution)
        error = np.maximum(power.std(axis=0, ddof=1) / REPLICATES**0.5, LEAST["discrete"])
        assert (np.abs(power.mean(axis=0) - 2) / error).max() < critical(REPLICATES, 6)


def test_a_continuous_walk_that_forgets_where_it_landed_is_rejected(exact, monkeypatch):
    begin = PathSegments.__init__

    def forgetful(self, tracer, method, *more):
        begin(self, tracer, replace(method, equation="discrete"), *more)

    monkeypatch.setattr(PathSegments, "__init__", forgetful)
    found = differences(rd.Method(equation="continuous"), exact)
    assert found["continuous"] > 2
    assert found["discrete"] < 1


def test_every_method_solves_one():
    assert {method.equation for method in accepted()} == set(EQUATIONS)
