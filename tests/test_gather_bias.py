"""Intervals of surfaces are right with polynomials, and hold the bias that these have along few stored lines.

Replicates do not show that bias.
"""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import lamp_lit

import radiosity as rd
from radiosity.algorithms.gather.tally import GatherTally

LINES = 400_000  # shortly before a correction, where the bias is largest beside the noise
# irradiance of surfaces by 30 million lines, seed 999; by its own intervals right to 0.15 % (the light: 0.3 %)
KNOWN = np.array(
    [
        [0.47814, 0.32516, 0.09216],
        [0.42773, 0.26049, 0.06398],
        [0.72598, 0.48614, 0.13712],
        [0.78268, 0.52816, 0.1575],
        [0.69585, 0.45007, 0.13466],
        [0.4597, 0.28847, 0.07439],
        [0.4687, 0.34297, 0.0926],
        [0.68508, 0.41745, 0.12147],
    ]
)


def solved(seeds: int = 6) -> list[rd.Solution]:
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=3)
    return [rd.solve(patches, "gather", basis="linear", rays=LINES, seed=seed) for seed in range(seeds)]


@pytest.fixture(scope="module")
def runs():
    return solved()


def held(solutions) -> float:
    """Return the share of the 95 % intervals that hold what is known."""
    return float(np.mean([(low <= KNOWN) & (high >= KNOWN) for low, high in (each.surface_interval() for each in solutions)]))


def unbiased(solutions) -> list[rd.Solution]:
    return [replace(each, side_bias=None) for each in solutions]


def test_intervals_hold_what_is_known(runs):
    assert held(runs) > 0.95  # 0.995 of 32 runs
    assert held(unbiased(runs)) > 0.9  # 0.96 of 32


def test_a_balance_that_takes_light_for_even_is_rejected(monkeypatch):
    """As if what leaves the box through its front were as bright as the mean over the walls."""
    monkeypatch.setattr(GatherTally, "_variation", lambda self, problem, state, group: np.zeros(state.sizes.rows))
    assert held(unbiased(solved(3))) < 0.85  # 0.82 of 24


def test_the_bias_is_in_rows_surfaces_and_the_scene_and_is_kept_in_files(runs, tmp_path):
    run = runs[0]
    spread, bias = replace(run, side_bias=None), run.side_bias
    assert (bias > 0).any(axis=1).sum() == 9  # eight fronts, and the back of the light
    for quantity in ("irradiance", "radiosity"):
        for ends, narrow in (
            (run.surface_interval(quantity=quantity), spread.surface_interval(quantity=quantity)),
            (run.scene_interval(quantity=quantity), spread.scene_interval(quantity=quantity)),
        ):
            assert (ends[1] - ends[0] > narrow[1] - narrow[0]).all()
    rows = zip(run.surface_table(), spread.surface_table(), strict=True)
    assert all(one["interval"] > other["interval"] for one, other in rows)
    run.save(tmp_path / "run.npz")
    np.testing.assert_array_equal(rd.load_solution(tmp_path / "run.npz").side_bias, bias)


def test_particles_have_no_bias_of_sums(runs):
    patches = runs[0].patches
    assert rd.solve(patches, "particle-tracing", basis="linear", rays=10_000).side_bias is None
    assert (rd.solve(patches, "gather", rays=10_000).side_bias > 0).any()


@pytest.mark.parametrize("method", ["gather", "density-estimation", "global-form-factors"])
def test_one_replicate_can_be_kept(tmp_path, runs, method):
    """Then biases that are measured between replicates are unknown."""
    one = rd.solve(runs[0].patches, method, rays=200_000, replicates=1)
    one.save(tmp_path / "one.npz")
    again = rd.load_solution(tmp_path / "one.npz")
    assert np.isnan(again.surface_interval()).all()
    assert (one.side_bias is None) == (again.side_bias is None)


@pytest.mark.filterwarnings("ignore:form factors from")
@pytest.mark.parametrize("lines", ["local", "global"])
def test_intervals_by_form_factors_hold_the_light_that_patches_get_back(lines):
    """The lamp gets its own light back by the lines that led it away: its irradiance is too high, in all replicates."""
    box = rd.subdivide(lamp_lit(0.8), cells=2)
    exact = rd.solve(box, "full-matrix").irradiance[:, 0]
    lamp = int(np.argmax(np.bincount(box.surface, box.emission[:, 0])))
    mean = np.average(exact[box.surface == lamp], weights=box.area[box.surface == lamp])
    runs = [rd.solve(box, order="matrix", lines=lines, rays=20_000, seed=seed) for seed in range(8)]

    def held(solutions) -> int:
        ends = [each.surface_interval() for each in solutions]
        return sum(bool(low[lamp, 0] <= mean <= high[lamp, 0]) for low, high in ends)

    assert held(runs) >= 6  # of 8 right ones fewer than 6 hold once in 170
    assert held(unbiased(runs)) < 6
