"""Runs of several stages: what is read of each of them is what its `quanta=` replay gives, and no run goes on to other bits.

One method for each kind of run; the ladder begins low, so that small runs have many stages.
"""

import numpy as np
import pytest
from members import PLAIN, accepted
from states import coloured, grey

import radiosity as rd
from radiosity.algorithms.table import ALGORITHMS
from radiosity.run import budget

pytestmark = pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of few lines

FIRST = 1 << 12  # quanta of all replicates in the first stage
LINES: dict[str, rd.Method] = {}  # of each kind of run that traces lines, the plainest method; and a variant of some
for one in accepted():
    LINES.setdefault(one.machine, one)
    if one.machine == "matrix":
        LINES.setdefault(f"matrix, {one.lines}", one)
LINES["depth-first"] = rd.Method(order="depth-first")
LINES["control variate"] = rd.Method(order="regular", control_variate=True)
BASELINES = {"progressive": rd.Baseline("progressive"), "hierarchical": rd.Baseline("hierarchical", samples=4)}
RESULTS = ("irradiance", "irradiance_standard_error", "arrivals", "surface_power")
SCALARS = ("rays", "quanta", "books", "status")


@pytest.fixture(autouse=True)
def low(monkeypatch):
    monkeypatch.setattr(budget, "FIRST_STAGE", FIRST)


def test_every_kind_of_run_is_here():
    assert {method.machine for method in (*LINES.values(), *BASELINES.values())} == set(ALGORITHMS) - {"full-matrix"}  # one stage
    assert LINES["firing"] == PLAIN


def assert_equal(one: rd.Solution, other: rd.Solution) -> None:
    for name in RESULTS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    for name in SCALARS:
        assert getattr(one, name) == getattr(other, name), name


def told_errors(patches, method, **options) -> tuple[rd.Solution, list[float]]:
    """A solution, and the error of each of its stages: those told while the next one went on, and its own."""
    errors: dict[int, float] = {}

    def listen(progress):
        if progress.stage:
            errors[progress.stage] = progress.error

    solution = rd.solve(patches, method, progress=listen, **options)
    return solution, [*(errors[stage] for stage in sorted(errors)), solution.error]


@pytest.mark.parametrize("name", LINES)
def test_stages_that_are_read_change_nothing(name):
    """The error after each stage is that of the stage, and the result that of its replay, which nobody looked at."""
    patches, method, options = grey()[1].patches, LINES[name], {"replicates": 4, "seed": 4}
    rung = budget.first_rung(method.order, 4, np.ones(len(patches)) / len(patches))
    solution, errors = told_errors(patches, method, quanta=4 * rung, **options)
    assert len(errors) == 3
    for stage, error in enumerate(errors):
        alone = rd.solve(patches, method, quanta=rung << stage, **options)
        assert alone.error == error
    assert_equal(solution, alone)
    target = min(0.9 * errors[1], 0.9)  # met after the second stage
    reached = rd.solve(patches, method, error=target, **options)
    assert reached.error <= target
    assert reached.quanta > 2 * rung
    assert_equal(reached, rd.solve(patches, method, quanta=reached.quanta, **options))


@pytest.mark.parametrize(("name", "steps"), [("progressive", 200), ("hierarchical", 4)])
def test_steps_of_baselines_that_are_read_change_nothing(name, steps):
    patches, method = rd.subdivide(grey()[1].patches.scene, cells=2), BASELINES[name]
    solution, errors = told_errors(patches, method, quanta=steps)
    assert len(errors) > 2
    assert_equal(solution, rd.solve(patches, method, quanta=steps))


@pytest.mark.parametrize("name", ["firing", "iteration", "walks", "gathering", "multipath", "pooling", "matrix"])
def test_a_coloured_run_goes_on_to_the_same_bits_or_is_refused(name):
    """Also from fewer quanta than the first rung has: powers of two that are on no ladder."""
    patches, method, options = coloured()[1].patches, LINES[name], {"replicates": 2, "seed": 4}
    rung = budget.first_rung(method.order, 2, np.ones(len(patches)) / len(patches))
    whole = rd.solve(patches, method, quanta=4 * rung, **options)
    for begun in (1, 512, rung // 2, rung, rung + 1, 3 * rung // 2, 2 * rung):
        before = rd.solve(patches, method, quanta=begun, **options)
        try:
            after = rd.solve(patches, method, quanta=4 * rung, resume=before, **options)
        except rd.MethodError as error:
            refused = str(error)
        else:
            assert_equal(after, whole)
            continue
        assert f"no power of two from {rung} on" in refused
        assert begun not in (rung, 2 * rung)
