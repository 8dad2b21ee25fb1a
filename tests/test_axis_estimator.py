"""Contract of an estimator and of an absorption: the mean is the exact solution, with each process, order, kind of lines, option
and preset that goes with it (`members.varied`).

The furnace cube (B = 2 everywhere) for the continuous equation, and with the slow tests for all; for the discrete one a cube of
unlike walls, whose solution by exact form factors is known (`cube_irradiance`). Power of each wall, mean of 32 replicates, by
Student's t at alpha = 1e-4 for all walls of a test together (`methods.critical`): with some hundred tests a false alarm has a
chance of 1 %, and seeds are fixed. Estimators that leave out a probability fail the same comparison.
"""

from dataclasses import replace

import drjit as dr
import numpy as np
import pytest
from enclosures import cube, cube_irradiance
from members import accepted, each, plainest, said, varied
from methods import critical
from replicates import powers

import radiosity as rd
from radiosity.algorithms.walks.gathering import Gathering
from radiosity.algorithms.walks.scores import Scores
from radiosity.device.backend import upload
from radiosity.method.estimator import ABSORPTIONS, ESTIMATORS

REPLICATES, RAYS = 32, 150_000
RHO, LIGHT = np.array([0.9, 0.1, 0.8, 0.2, 0.7, 0.3]), np.array([1.0, 0.1, 0.2, 0.5, 0.1, 2.0])
START_UP = 1e-4  # of the light, that iterations may leave out as they begin (docs/iterations.md); some have no variance here
BOUND = critical(REPLICATES, 6)


def off(method: rd.Method, reflectance, emission, exact) -> float:
    """The largest difference of walls, in standard errors."""
    patches = rd.subdivide(cube(reflectance, emission), cells=1)
    power = powers(rd.solve(patches, method, rays=RAYS, replicates=REPLICATES))
    error = power.std(axis=0, ddof=1) / REPLICATES**0.5
    assert (error < 0.02 * power.mean(axis=0)).all()
    return float((np.abs(power.mean(axis=0) - exact) / np.maximum(error, START_UP * power.mean(axis=0))).max())


def off_of_unlike_walls(method: rd.Method) -> float:
    return off(method, RHO[:, None], LIGHT[:, None], cube_irradiance(RHO, LIGHT))


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_some_process_takes_the_estimator(estimator):
    assert plainest("estimator", estimator)


@pytest.mark.parametrize("absorption", ABSORPTIONS)
def test_some_process_takes_the_absorption(absorption):
    assert plainest("absorption", absorption)


def discrete(method: rd.Method) -> bool:
    return method.equation == "discrete"


@pytest.mark.parametrize("absorption", ["rounded", "drawn"])
def test_an_absorption_that_is_said_is_the_same(absorption):
    """So the suites of the axes run such methods without its name alone."""
    method = next(one for one in accepted() if said(one) and one.absorption == absorption)
    patches = rd.subdivide(cube(RHO[:, None], LIGHT[:, None]), cells=1)
    one, other = (rd.solve(patches, chosen, quanta=1000, replicates=2) for chosen in (method, replace(method, absorption="auto")))
    assert np.array_equal(one.irradiance, other.irradiance)
    assert one.rays == other.rays


class TestContract:
    @each(varied, "estimator", "absorption", slow=discrete)
    def test_the_mean_is_exact_in_the_furnace(self, method):
        assert off(method, 0.5, 1.0, 2.0) < BOUND

    @each(varied, "estimator", "absorption", slow=lambda method: not discrete(method))
    def test_the_mean_is_exact_between_unlike_walls(self, method):
        if discrete(method) and method.basis == "constant":  # polynomials are nearer to the light itself, see test_bases
            assert off_of_unlike_walls(method) < BOUND


def test_absorption_without_its_probability_is_rejected(monkeypatch):
    monkeypatch.setattr(Scores, "_score", lambda self, brought, p, alive: dr.select(alive, 0, brought))
    assert off_of_unlike_walls(rd.Method(estimator="absorption")) > 2 * BOUND


def test_survival_without_its_probability_is_rejected(monkeypatch):
    monkeypatch.setattr(Scores, "_score", lambda self, brought, p, alive: dr.select(alive, brought, 0))
    assert off_of_unlike_walls(rd.Method(estimator="survival")) > 2 * BOUND


def test_gathering_without_its_probability_is_rejected(monkeypatch):
    before = Gathering._prepare

    def wrong(self):
        before(self)
        self.ratio = [upload(self.types.Float, np.array(self.survival))]

    monkeypatch.setattr(Gathering, "_prepare", wrong)
    assert off_of_unlike_walls(rd.Method(estimator="gathering")) > 2 * BOUND


def test_every_method_has_one():
    assert {method.estimator for method in accepted()} == set(ESTIMATORS)
    assert {method.absorption for method in accepted()} == {"auto", *ABSORPTIONS}
