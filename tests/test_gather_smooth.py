"""Smoothed gathers: less error, held by the stated one, and surfaces receive what they received before."""

import numpy as np
import pytest
from replicates import powers, process_of
from scipy.stats import t

import radiosity as rd
from radiosity.algorithms.gather.smooth import SmoothTally
from radiosity.algorithms.gather.tally import GatherTally
from radiosity.problem.model import Problem
from radiosity.run.snapshot import Snapshot
from radiosity.solution.binomial import smoothed

SEEDS = 3


@pytest.fixture(scope="module")
def room():
    """The patches of a room, and what they receive, from 24 times as many lines."""
    patches = rd.subdivide(rd.load_scene("room"), cells=12)
    return patches, rd.solve(patches, "gather", rays=12_000_000, seed=50)


@pytest.fixture(scope="module")
def pairs(room):
    """Solutions without and with smoothing, of equal lines."""
    return [
        [rd.solve(room[0], "gather", rays=500_000, seed=seed, reconstruction=how) for how in ("patches", "smooth")]
        for seed in range(SEEDS)
    ]


def test_errors_fall_and_the_stated_ones_hold_them(room, pairs):
    """Neighbours err together, so there is no p-value: 0.95 of the patches were held, and errors fell by 1.3."""
    patches, truth = room
    half, held, squares = t.ppf(0.975, 7), [], np.zeros(3)
    for plain, smooth in pairs:
        off, less = ((one.irradiance - truth.irradiance)[:, 0] for one in (plain, smooth))
        stated = np.hypot(smooth.irradiance_standard_error, truth.irradiance_standard_error)[:, 0]
        held.append(np.abs(less) <= half * stated)
        squares += patches.area @ (off**2), patches.area @ (less**2), patches.area @ (stated**2)
        assert smooth.error < plain.error
    assert np.mean(held) > 0.93
    assert squares[0] > 1.15**2 * squares[1]
    assert 0.9 < np.sqrt(squares[2] / squares[1]) < 1.5


def test_smoothing_changes_what_is_read_and_nothing_else(pairs):
    """Sums, the power of surfaces, and the energy balance are those of a run without it."""
    for plain, smooth in pairs:
        assert all((smooth.state[name] == value).all() for name, value in plain.state.items())
        assert (smooth.rays, smooth.quanta) == (plain.rays, plain.quanta)
        assert smooth.irradiance.min() >= 0
        assert powers(smooth) == pytest.approx(powers(plain), rel=1e-12)
        for name in ("emitted", "absorbed"):
            assert smooth.books[0][name] == pytest.approx(plain.books[0][name], rel=1e-12)
        for name in ("rounding", "lost"):  # these follow the patches that stored lines left from
            assert smooth.books[0][name] == pytest.approx(plain.books[0][name], abs=1e-3 * plain.books[0]["emitted"])
        assert np.mean(smooth.irradiance != plain.irradiance) > 0.5


def test_direct_light_is_smoothed_by_itself(room, monkeypatch):
    """Together with the rest, edges of its shadows would leave the rest's noise as it is: patches beside them have more error."""
    patches, truth = room

    def error(seed: int) -> float:
        found = rd.solve(patches, "gather", rays=500_000, seed=seed, reconstruction="smooth")
        return float(patches.area @ (found.irradiance - truth.irradiance)[:, 0] ** 2)

    def together(values: np.ndarray, unit: float):
        return *smoothed(patches, values), unit

    apart = sum(error(seed) for seed in range(SEEDS))
    plain = GatherTally.irradiance
    monkeypatch.setattr(SmoothTally, "_smoothed", lambda self, *which: together(*plain(self.plain, *which)))
    assert sum(error(seed) for seed in range(SEEDS)) > 1.03 * apart


def test_errors_of_means_do_not_hold_the_bias_of_patches(room, pairs):
    """Smoothing keeps the power of surfaces, so the error of a mean is what it was."""
    patches, problem = room[0], Problem.of(room[0])
    floor = np.array([patches.scene.names.index("floor")])
    rows = np.flatnonzero(patches.surface == floor[0])
    plain, smooth = (
        Snapshot(problem, process.tally, process.read(one.state, process.sizes), one.replicates)
        for one in pairs[0]
        for process in [process_of(one, problem)]
    )
    assert smooth.error_of_mean(rows, floor) == pytest.approx(plain.error_of_mean(rows, floor), rel=1e-9)


def test_a_tally_reads_each_state_anew():
    """In bands, too: what was kept of one state is not read of another."""
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=3)
    problem, tally, found = Problem.of(patches), SmoothTally(GatherTally()), []
    for rays in (60_000, 600_000):
        solution = rd.solve(patches, "gather", rays=rays, seed=1, reconstruction="smooth")
        algorithm = process_of(solution, problem)
        state = algorithm.read(solution.state, algorithm.sizes)
        for group in range(3):
            values, unit = tally.irradiance(problem, state, group)
            assert values is tally.irradiance(problem, state, group)[0]
            found.append(values.mean(axis=0) * unit / patches.area * problem.groups.scale[group])
            assert found[-1] == pytest.approx(solution.irradiance[:, group], rel=1e-12)
    assert len({values.tobytes() for values in found}) == 6


def test_one_replicate_is_refused_with_the_reason():
    patches = rd.subdivide(rd.load_scene("room"), cells=2)
    with pytest.raises(rd.MethodError, match="needs 2 or more, not 1"):
        rd.solve(patches, "gather", rays=10_000, replicates=1, reconstruction="smooth")
    assert np.isfinite(rd.solve(patches, "gather", rays=10_000, replicates=2, reconstruction="smooth").irradiance).all()
