"""The mean of many short runs, of every method, in a lamp-lit room: right within the bias that the method states (contract 12).

In a furnace many faults leave no trace. Here a small lamp lights a box whose floor is darker than the rest: 200 independent
runs of 2 000 lines (36 a patch), surface by surface. Methods of the discrete equation are held to exact form factors of
polygons, those of the continuous one to 60 million lines of drawn random walks. Student's t, alpha = 1e-3 for all methods and
surfaces together (Bonferroni), one comparison a method and surface; what a method states as its bias is allowed on top, and
nothing else.
"""

import numpy as np
import pytest
from enclosures import lamp_lit
from methods import METHODS
from replicates import powers
from scipy.stats import t as student

import radiosity as rd
from radiosity.algorithms.base import AbstractBiasedTally
from radiosity.algorithms.table import make
from radiosity.device.backend import choose
from radiosity.problem.model import Problem
from radiosity.problem.quanta import Source
from radiosity.tracing.geometry import Geometry

pytestmark = pytest.mark.filterwarnings("ignore:form factors from")  # it tells of the bias that is allowed for here
RUNS, LINES, ALPHA = 200, 2_000, 1e-3
START_UP = 1e-4  # of the light: what regular iterations leave out where they begin without a warm-up (docs/iterations.md)
BOTH_ENDS = {"estimator": "bidirectional", "control_variate": True}
TABLE = METHODS | {
    "stochastic-jacobi, everything": rd.Method(order="regular", warm_up=True, **BOTH_ENDS),
    "the same, one shift": rd.Method(order="regular", warm_up=True, randomisation="shared", **BOTH_ENDS),
    "incremental, everything": rd.Method(order="incremental", **BOTH_ENDS),
    "regular, everything": rd.Method(order="regular", **BOTH_ENDS),
    "random-walk, one shift": rd.Method(randomisation="shared"),
    "random-walk, sobol": rd.Method(numbers="sobol"),
    "random-walk, random": rd.Method(numbers="random"),
    "pooled, disc": rd.Method(lines="global-disc", order="regular"),
}
QUICK = ("random-walk", "discrete, fractional", "stochastic-jacobi, everything", "pooled, spans, first shot", "matrix, local")
SURFACES = 7


@pytest.fixture(scope="module")
def room():
    return rd.subdivide(lamp_lit(0.8, floor=0.3), cells=2)


@pytest.fixture(scope="module")
def discrete(room):
    """(SURFACES,) W: from exact form factors, which are right to 1e-8 where the answer is known."""
    alike = rd.subdivide(lamp_lit(0.8), cells=2)
    mean = np.average(rd.solve(alike, "full-matrix").irradiance[:, 0], weights=alike.area)
    assert abs(mean * alike.area.sum() * 0.2 / (alike.emission[:, 0] @ alike.area) - 1) < 1e-7
    return np.bincount(room.surface, room.area * rd.solve(room, "full-matrix").irradiance[:, 0])


@pytest.fixture(scope="module")
def references(room, discrete):
    """By equation: (SURFACES,) W and its standard error."""
    walks = rd.Method(equation="continuous", order="depth-first", numbers="random", absorption="drawn")
    power = powers(rd.solve(room, walks, rays=60_000_000, replicates=16, seed=99))
    return {
        "discrete": (discrete, np.zeros(SURFACES)),
        "continuous": (power.mean(axis=0), power.std(axis=0, ddof=1) / len(power) ** 0.5),
    }


def excess(patches, method: rd.Method, reference, error=0.0, lines: int = LINES) -> np.ndarray:
    """(SURFACES,) how far the mean of all runs is off, beyond the bias that is stated, in standard errors."""
    solution = rd.solve(patches, method, rays=RUNS * lines, replicates=RUNS, seed=7)
    power, problem = powers(solution), Problem.of(patches)
    algorithm = make(Geometry(patches, choose("cpu")), problem, method, 7, RUNS)
    tally, state = algorithm.tally, algorithm.read(solution.state, algorithm.sizes)
    stated = START_UP * reference * (method.order == "regular" and method.lines == "local" and not method.warm_up)
    if isinstance(tally, AbstractBiasedTally):
        _, unit = tally.irradiance(problem, state, 0)
        stated = stated + np.bincount(patches.surface, tally.bias(problem, state, 0)) * unit
    spread = np.hypot(power.std(axis=0, ddof=1) / RUNS**0.5, error)
    return np.maximum(np.abs(power.mean(axis=0) - reference) - stated, 0) / spread


BOUND = float(student.ppf(1 - ALPHA / 2 / (SURFACES * len(TABLE)), RUNS - 1))


@pytest.mark.parametrize("name", QUICK)
def test_means_are_right_in_a_lamp_lit_room(room, discrete, name):
    assert excess(room, TABLE[name], discrete).max() < BOUND


@pytest.mark.slow
@pytest.mark.parametrize("name", TABLE)
def test_every_mean_is_right_within_its_stated_bias(room, references, name):
    assert excess(room, TABLE[name], *references[TABLE[name].equation]).max() < BOUND


def test_a_hundredth_more_reflectance_is_rejected(room, discrete, monkeypatch):
    fixed = Source.fixed
    monkeypatch.setattr(Source, "fixed", staticmethod(lambda reflectance: fixed(1.01 * reflectance)))
    assert excess(room, TABLE["random-walk"], discrete).max() > 1.5 * BOUND


@pytest.mark.slow
@pytest.mark.parametrize("name", ["matrix, local", "global-form-factors"])
def test_own_light_that_is_not_stated_is_rejected(room, discrete, monkeypatch, name):
    """Patches get back their own light by the spans that led it away: 40 % too much on the lamp, by global lines."""
    from radiosity.factors import counted

    monkeypatch.setattr(counted, "of_own_light", lambda *arguments, **named: np.zeros(len(room)))
    assert excess(room, TABLE[name], discrete).max() > BOUND


@pytest.mark.slow
def test_the_wrong_equation_is_rejected(room, references):
    """On large patches the two equations differ by half a per cent, and the lamp by seven."""
    assert excess(room, TABLE["random-walk"], *references["continuous"], lines=8 * LINES).max() > 1.5 * BOUND
