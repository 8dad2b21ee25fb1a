"""The ladder of stages, and what of a budget is left: numbers alone, nothing is traced."""

import math

import numpy as np
import pytest

from radiosity.run.budget import (
    FIRST_STAGE,
    LEAST_QUANTA,
    Budget,
    Progressed,
    first_rung,
    first_stage,
    next_quanta,
    on_ladder,
    rung_after,
)


def test_the_first_stage_outweighs_a_pass_over_the_patches():
    for replicates, patches in ((1, 100), (8, 100), (8, 10**6), (1, 10**7), (1000, 10)):
        first = first_stage(replicates, patches)
        assert first & (first - 1) == 0
        assert first >= max(LEAST_QUANTA, 2 * patches / math.sqrt(2))
        assert first <= max(LEAST_QUANTA, math.sqrt(2) * max(FIRST_STAGE / replicates, 2 * patches))


def test_rungs_of_the_orders():
    share = np.array([0.9, 0.1 - 1e-4, 1e-4, 0.0])  # power of four patches, one of them dark
    usual = first_stage(2, 4)
    assert first_rung("breadth-first", 2, share) == usual == FIRST_STAGE // 2
    assert first_rung("staged", 2, share) == LEAST_QUANTA
    assert first_rung("well-distributed", 2, share) == 1 << 14  # a quantum is no more than the weakest light
    assert first_rung("well-distributed", 2, np.array([0.5, 0.5])) == LEAST_QUANTA
    assert first_rung("well-distributed", 2, np.array([1 - 1e-12, 1e-12])) == usual
    assert [first_rung(scheme, 2, share) for scheme in ("full-matrix", "progressive", "hierarchical")] == [1, 64, 1]


def test_the_ladder_doubles():
    rungs = [1024]
    while rungs[-1] < 10**6:
        assert on_ladder(rungs[-1], 1024)
        rungs.append(rung_after(rungs[-1], 1024))
    assert rungs == [1 << k for k in range(10, 21)]
    assert rung_after(0, 1024) == rung_after(1023, 1024) == 1024
    assert rung_after(1025, 1024) == 2048
    assert rung_after(2047, 1024) == 2048
    assert not any(on_ladder(quanta, 1024) for quanta in (1, 512, 1023, 1025, 3072))


def after(quanta: int, **known) -> Progressed:
    return Progressed(**({"quanta": quanta, "lines": 20 * quanta, "seconds": 1.0, "stage_seconds": 0.5, "error": 0.1} | known))


@pytest.mark.parametrize(
    ("budget", "quanta", "expected"),
    [
        ({"quanta": 5000}, 1024, 2048),  # rung by rung, then what was asked for
        ({"quanta": 5000}, 4096, 5000),
        ({"quanta": 5000}, 5000, None),
        ({"rays": 100_000}, 1024, 2048),  # twenty lines a quantum: 5000 of them
        ({"rays": 100_000}, 4096, 5000),
        ({"rays": 100_000}, 4990, None),  # less than a hundredth is missing
        ({"error": 0.05}, 1024, 2048),
        ({"error": 0.0999}, 4096, math.ceil(4096 * (0.1 / (0.97 * 0.0999)) ** 2)),  # a little more, as errors fall
        ({"error": 0.1}, 4096, None),
        ({"error": 0.2}, 4096, None),
        ({"seconds": 1.0}, 4096, None),
        ({"seconds": 100.0}, 4096, 8192),
    ],
)
def test_what_comes_next(budget, quanta, expected):
    assert next_quanta(Budget(**budget), 2, 1024, after(quanta), replay=False) == expected


def test_an_error_that_is_reached_ends_a_run():
    for error in (0.05, 0.04):
        assert next_quanta(Budget(error=0.05), 2, 1024, after(2048, error=error), replay=False) is None


def test_seconds_that_are_left_become_lines():
    """A stage fires about half of all lines so far, in its seconds; of what they would make of the rest, nine tenths."""
    at = after(4096, seconds=1.0, stage_seconds=0.5)
    found = next_quanta(Budget(seconds=1.2), 2, 1024, at, replay=False)
    assert found == round(4096 * (1 + 0.9 * 0.2 / 0.5 / 2))


def test_what_depends_on_stages_goes_on_from_rungs_alone():
    assert next_quanta(Budget(quanta=10_000), 2, 1024, after(5000), replay=True) is None
    assert next_quanta(Budget(quanta=10_000), 2, 1024, after(5000), replay=False) == 8192
    assert next_quanta(Budget(quanta=10_000), 2, 1024, after(4096), replay=True) == 8192
