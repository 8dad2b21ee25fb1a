"""Unbiased where the derivation says so, and the same test rejects what is wrong.

Each test compares the mean of independent short runs (replicates, each with a key and rounding offsets of its own) with a
reference, surface by surface: the exact solution of the cube, and of the room one of 16 million lines of Halton numbers, whose
error is a small part of theirs. Student's t, alpha = 1e-3 in all, shared out among the surfaces (Bonferroni). There are 2048 runs
of some lines a patch, which show a bias of second order too, and 512 of 40 000 lines; what is grossly wrong is rejected by a
quarter of them. Numbers are random, for which the derivations of docs/iterations.md hold; seeds are fixed.
"""

from dataclasses import replace

import drjit as dr
import numpy as np
import pytest
from enclosures import cube, cube_irradiance, lamp_lit
from iterations import VARIANTS, open_room
from replicates import powers
from scipy.stats import t as student
from some_cases import some

import radiosity as rd
from radiosity.algorithms.iterations.exchange import LINE, Exchange
from radiosity.tally.scores import Ends
from radiosity.tally.shooter import Shooter

RUNS, SOME_RUNS, LONG_RUNS, SHORT_RUNS, ALPHA = 2048, 512, 512, 768, 1e-3
UNBIASED = ("incremental", "incremental, both ends", "incremental, control variate", "regular, warm-up")
CONSISTENT = ("regular", "regular, both ends", "regular, control variate", "regular, everything")


@pytest.fixture(scope="module")
def room():
    """Few patches with unlike reflectances, an opening, and the power that surfaces receive."""
    patches = rd.subdivide(open_room(), cells=1)
    return patches, powers(rd.solve(patches, "random-walk", rays=16_000_000, replicates=16)).mean(axis=0)


@pytest.fixture(scope="module")
def lit():
    """A closed cube whose sides all emit, and differ in what they reflect: power that comes back matters from the start."""
    reflectance, emission = np.array([0.95, 0.1, 0.9, 0.2, 0.9, 0.1]), np.array([1.0, 0.1, 0.2, 0.5, 0.1, 2.0])
    patches = rd.subdivide(cube(reflectance[:, None], emission[:, None]), cells=1)
    return patches, cube_irradiance(reflectance, emission)


def statistic(scene, name: str, quanta: int, runs: int = RUNS) -> tuple[float, float]:
    """The largest t of all surfaces, and the bound that it exceeds with probability ALPHA if there is no bias."""
    patches, exact = scene
    method = rd.Method(**VARIANTS[name], numbers="random")
    power = powers(rd.solve(patches, method, quanta=quanta, replicates=runs, seed=1))
    seen = power.std(axis=0) > 0
    t = (power.mean(axis=0) - exact)[seen] / (power.std(axis=0, ddof=1)[seen] / runs**0.5)
    return float(np.abs(t).max()), float(student.ppf(1 - ALPHA / 2 / seen.sum(), runs - 1))


@pytest.mark.parametrize("quanta", [5, pytest.param(40, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", UNBIASED)
def test_short_runs_are_right_in_the_mean(room, name, quanta):
    """5 quanta: fewer lines than patches, so that rounding and roulette decide nearly everything."""
    largest, bound = statistic(room, name, quanta)
    assert largest < bound


@pytest.mark.parametrize("quanta", [pytest.param(6, marks=pytest.mark.slow), 40])
@pytest.mark.parametrize("name", UNBIASED)
def test_short_runs_are_right_where_all_sides_emit(lit, name, quanta):
    largest, bound = statistic(lit, name, quanta)
    assert largest < bound


@pytest.mark.slow
@pytest.mark.parametrize("name", CONSISTENT)
def test_long_runs_are_right_in_the_mean(room, name):
    """Start-up, medians and variances of what was received make these consistent only: the bias must be below the noise of
    512 runs of 40 000 lines, that of a run of 20 million."""
    largest, bound = statistic(room, name, 40_000, LONG_RUNS)
    assert largest < bound


def test_restarted_indices_are_rejected(lit, monkeypatch):
    """Each iteration fires the lines of the last one again."""
    shoot = Shooter.shoot

    def again(self, *arguments, **named):
        sequences = self.sequences
        before, sequences.fired = sequences.fired, dr.opaque(self.types.UInt32, 0, self.total)
        result = shoot(self, *arguments, **named)
        sequences.fired = sequences.fired + before  # all are counted, or the state would be refused
        return result

    monkeypatch.setattr(Shooter, "shoot", again)
    largest, bound = statistic(lit, "incremental", 6, 1024)
    assert largest > 1.5 * bound


def test_missing_probabilities_are_rejected(room, monkeypatch):
    """A patch that fires a line with probability c sends its power, not its power over c."""
    send, counts, true = Exchange.send, Exchange.counts, {}

    def wrong(self, power, expected, *more):
        true["expected"] = expected
        return send(self, power, dr.maximum(expected, LINE), *more)

    monkeypatch.setattr(Exchange, "send", wrong)
    monkeypatch.setattr(Exchange, "counts", lambda self, expected: counts(self, true["expected"]))
    largest, bound = statistic(room, "incremental", 40, SOME_RUNS)
    assert largest > 1.5 * bound


def test_swapped_weights_are_rejected(lit, monkeypatch):
    """q_j / (q_i + q_j) where q_i / (q_i + q_j) belongs, by reciprocal densities."""
    ends = Exchange._ends

    def swapped(self, power, mean):
        right = ends(self, power, mean)
        density = dr.select(right.density > 0, 1 / right.density, 1e20)
        carried = dr.select(right.density > 0, right.carried / right.density**2, 0)
        dr.eval(density, carried)
        return Ends(density, carried)

    monkeypatch.setattr(Exchange, "_ends", swapped)
    largest, bound = statistic(lit, "incremental, both ends", 40, SOME_RUNS)
    assert largest > 1.5 * bound


def test_a_start_at_the_light_that_is_kept_is_rejected(room, monkeypatch):
    """Without start-up the first iterations are too dark, and the mean remembers them."""
    from radiosity.algorithms.iterations import plan

    monkeypatch.setattr(plan, "DARK", 0.999)
    largest, bound = statistic(room, "regular", 10_000, LONG_RUNS // 4)
    assert largest > 1.5 * bound


EVERYTHING = rd.Method(**VARIANTS["regular, everything"], randomisation="shared")  # with a shift of each patch one sees less


def mean_of_the_box(method: rd.Method, runs: int) -> tuple[float, float, float]:
    """Of short runs with few lines a patch in the lamp-lit box: how much too high the mean irradiance is, its standard error, and
    Student's bound at ALPHA."""
    patches = rd.subdivide(lamp_lit(0.9), cells=4)
    power = powers(rd.solve(patches, method, quanta=1024, replicates=runs, seed=5)).sum(axis=1)
    excess = power / (patches.emission[:, 0] @ patches.area / 0.1) - 1
    return float(excess.mean()), float(excess.std(ddof=1) / runs**0.5), float(student.ppf(1 - ALPHA / 2, runs - 1))


CHOICES = {"halton": {}, "sobol": {"numbers": "sobol"}, "by patch": {"randomisation": "by-patch"}}


@some(["halton"], ["sobol", "by patch"])  # they differ in how points are made; steps take them apart in one way
def test_low_discrepancy_numbers_bring_no_bias_where_both_ends_score(name):
    """Five lines a patch. The mean was 2 % too high where each step took the points next to those that it knew the result of."""
    excess, error, bound = mean_of_the_box(replace(EVERYTHING, **CHOICES[name]), SHORT_RUNS)
    assert abs(excess) < bound * error
    assert error < 0.004


def test_steps_that_know_their_points_are_rejected(monkeypatch):
    """One sequence for all steps."""
    from radiosity.algorithms.iterations import exchange

    monkeypatch.setattr(exchange, "TURNS", 1)
    excess, error, bound = mean_of_the_box(EVERYTHING, SHORT_RUNS)
    assert excess > 1.5 * bound * error
