"""Every method, named or combined, solves the same problems within its own error bars: furnaces, the room, and an open scene of
two-sided faces.

Differences are per surface, in combined standard errors of 16 replicates; bounds are Student's at alpha = 1e-4 for all surfaces
of a test together, so that a false alarm among its some hundred cases has a chance of 1 %. Seeds are fixed.
"""

import numpy as np
import pytest
from members import varied
from methods import COMBINATIONS, METHODS, critical
from replicates import difference, powers

import radiosity as rd
from radiosity.lab import cases
from radiosity.method.model import CHOICES

RAYS, REPLICATES = 750_000, 16
START_UP = 1e-4  # of the light, that iterations may leave out as they begin (docs/iterations.md); some have no variance here


@pytest.fixture(scope="module")
def room():
    return rd.subdivide(rd.load_scene("room"), cells=2)


@pytest.fixture(scope="module")
def plates():
    return cases.plates().patches


REFERENCES = {"discrete": rd.Method(), "continuous": rd.Method(equation="continuous")}


@pytest.fixture(scope="module")
def reference(room, plates):
    scenes = {"room": room, "plates": plates}
    known = {}

    def get(name, equation):
        if (name, equation) not in known:
            solution = rd.solve(scenes[name], REFERENCES[equation], rays=4_000_000, replicates=REPLICATES, seed=77)
            known[name, equation] = powers(solution)
        return known[name, equation]

    return get


SLOW = pytest.mark.slow


# combinations that test_axis_estimator.py puts into closed scenes of its own
VARIED = {method for axis in ("estimator", "absorption") for value in CHOICES[axis] for method in varied(axis, value)}
ELSEWHERE = {name for name, method in COMBINATIONS.items() if method in VARIED}
SOME = pytest.mark.parametrize("name", [pytest.param(name, marks=SLOW) if name in ELSEWHERE else name for name in METHODS])


@pytest.mark.parametrize("mean_reflectance", [pytest.param(0.1, marks=SLOW), pytest.param(0.5, marks=SLOW), 0.9])
@SOME
def test_furnace(name, mean_reflectance):
    patches = rd.subdivide(rd.load_scene(f"labyrinth-{mean_reflectance}"), cells=1)
    solution = rd.solve(patches, METHODS[name], rays=RAYS, replicates=REPLICATES)
    exact = np.bincount(patches.surface, patches.area)
    power = powers(solution)
    error = np.maximum(power.std(axis=0, ddof=1) / REPLICATES**0.5, START_UP * exact)
    assert np.abs((power.mean(axis=0) - exact) / error).max() < critical(REPLICATES, len(exact))
    assert np.average(np.abs(solution.radiosity[:, 0] - 1), weights=patches.area) < 0.1


@SOME
def test_room(name, room, reference):
    compare(METHODS[name], room, reference("room", METHODS[name].equation))


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_open_scene_of_two_sided_faces(method, plates, reference):
    compare(method, plates, reference("plates", method.equation))


def compare(method, patches, expected):
    solution = rd.solve(patches, method, rays=RAYS, replicates=REPLICATES)
    power = powers(solution)
    spread = power.std(axis=0, ddof=1) / REPLICATES**0.5 / expected.mean(axis=0)
    assert np.median(spread) < 0.05  # an error bar as wide as the room would agree with anything
    assert np.abs(difference(power, expected)).max() < critical(REPLICATES, power.shape[1])


def test_the_two_equations_differ_and_the_program_knows(room, reference):
    """On large patches the continuous solution is another one: each method fits its own reference and not the other's."""
    between = difference(reference("room", "discrete"), reference("room", "continuous"))
    assert np.abs(between).max() > 5 * critical(REPLICATES, len(between))
