"""`make bench-error`: its formulas against closed forms, its references, and its photon loop."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import radiosity as rd
from benchmarks.error_formulas import error_at, means_squares, rms, squares, surface_means, time_to

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


def power_law(seconds, slope=0.6):
    """Errors that fall as a power of time: 10 % after one second."""
    return 0.1 * np.asarray(seconds) ** -slope


@pytest.mark.parametrize(("target", "mark"), [(0.07, ""), (0.01, ""), (0.004, "*")])
def test_a_power_law_is_joined_and_drawn_on(target, mark):
    seconds = [1, 4, 16, 64, 128]
    time = time_to(target, power_law(seconds), seconds)
    assert time.mark == mark
    assert time.seconds == pytest.approx((0.1 / target) ** (1 / 0.6))
    if not mark:
        assert error_at(time.seconds, power_law(seconds), seconds) == pytest.approx(target)


def test_the_error_must_stay_below_the_target():
    """The second run is below by chance, and the third is above again: the last crossing counts."""
    time = time_to(0.01, [0.1, 0.005, 0.02, 0.005], [1, 2, 4, 16])
    assert time.seconds == pytest.approx(8)


def test_what_is_not_known_is_told():
    assert str(time_to(0.01, [0.005, 0.002], [1.5, 4])) == "<1.5"
    assert str(time_to(0.01, [0.1], [1])) == "-"
    assert str(time_to(0.01, [0.1, 0.1], [1, 4])) == "-"
    assert str(time_to(0.01, [0.1, np.nan], [1, 4])) == "-"
    assert str(time_to(0.025, [0.1, 0.05], [1, 4])) == "16*"
    assert np.isnan(error_at(0.5, [0.1, 0.05], [1, 4]))
    assert np.isnan(error_at(5, [0.1, 0.05], [1, 4]))


def test_the_error_is_that_of_a_solution():
    """`Solution.error` is the relative error of values that are off by their standard errors; black patches do not count."""
    solution = rd.solve(rd.subdivide(rd.load_scene("cornell-box"), cells=2), "random-walk", rays=20_000, replicates=4, seed=3)
    patches, off = solution.patches, solution.irradiance + solution.irradiance_standard_error
    found = squares(patches.reflectance, patches.area, off, solution.irradiance)
    assert found.shape == (3,)
    assert np.sqrt(found.max()) == pytest.approx(solution.error)


def test_errors_are_weighted_by_area_and_reflectance():
    area, reflectance = np.array([1.0, 3.0, 5.0]), np.array([[0.5], [1.0], [0.0]])
    truth, values = np.array([[2.0], [1.0], [7.0]]), np.array([[2.2], [1.0], [1.0]])
    # B - E is 1, 1 and 0; the first is off by 0.1 on a quarter of the area that reflects
    assert squares(reflectance, area, values, truth) == pytest.approx([0.01 / 4])


def test_surface_means_and_their_error():
    area, surface = np.array([1.0, 3.0, 2.0]), np.array([2, 2, 0])
    irradiance = np.array([[4.0, 8.0], [8.0, 8.0], [6.0, 2.0]])
    sizes, means = surface_means(np.full((3, 2), 0.5), area, surface, irradiance)
    assert sizes == pytest.approx([2, 4])  # no patch is on surface 1
    assert means == pytest.approx(np.array([[3, 1], [3.5, 4]]))
    off = means + np.array([[0.3, 0], [0, 0]])
    assert means_squares(sizes, off, means) == pytest.approx([2 * 0.09 / (2 * 9 + 4 * 12.25), 0])


def test_the_variance_of_the_reference_is_subtracted():
    assert rms([[4e-4, 1e-5], [2e-4, 1e-5]], np.array([1e-4, 0])) == pytest.approx(np.sqrt(2e-4))
    assert rms([[1e-4]], np.array([2e-4])) == 0


def test_rms_of_noise_is_that_of_the_values():
    """Values off by 2 %, a reference off by 1 %: the error is 2 %, and not the 2.24 % that they differ by."""
    draw, n = np.random.default_rng(1), 20_000
    truth, one = np.full((n, 1), 3.0), np.ones((n, 1))
    reference = truth * (1 + 0.01 * draw.standard_normal((n, 1)))
    runs = [squares(one, np.ones(n), truth * (1 + 0.02 * draw.standard_normal((n, 1))), reference) for _ in range(3)]
    # the mean square of 60 000 normal values is known to 0.6 %
    assert rms(runs, np.array([1e-4])) == pytest.approx(0.02, rel=0.02)
    assert rms(runs, np.array([0.0])) > 0.022


@pytest.mark.parametrize(("bias", "agrees"), [(0.0, True), (0.02, False), (0.003, False)])
def test_references_are_put_together(tmp_path, monkeypatch, bias, agrees):
    """Two methods whose errors are 1 % and 2 %, where the second may also be biased; a small bias shows in means alone."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import error_references

    draw, n, files = np.random.default_rng(2), 4000, {}
    for method, error, off in (("one", 0.01, 0.0), ("two", 0.02, bias)):
        files[method] = tmp_path / f"{method}.npz"
        irradiance = 1 + off + error * draw.standard_normal((n, 1))
        its = {"variance": np.array([error**2]), "means_variance": np.array([error**2 / n])}
        its |= {"reflectance": np.full((n, 1), 0.5), "area": np.ones(n), "surface": np.zeros(n, int)}
        np.savez(files[method], irradiance=irradiance, **its)
    found = error_references._together(tmp_path / "discrete.npz", files)
    assert found.agrees is agrees
    assert found.variance == pytest.approx([1 / (1 / 0.01**2 + 1 / 0.02**2)])
    assert found.means_variance == pytest.approx(found.variance / n)
    if not bias:
        mean = np.load(found.file)["irradiance"]
        assert np.mean((mean - 1) ** 2) == pytest.approx(found.variance[0], rel=0.1)


def test_the_photon_loop_agrees_with_particle_tracing():
    """In a process of its own, since it sets Mitsuba's variant: means over surfaces within 5 standard errors of both."""
    code = """
import numpy as np, radiosity as rd
from error_photons import photons
from error_scenes import divided_room
patches = rd.subdivide(divided_room(0.5, 8), cells=1)
walk = rd.solve(patches, "particle-tracing", rays=2_000_000, seed=1)
runs = [photons(patches, 500_000, seed).irradiance[:, 0] for seed in range(6)]
area = np.bincount(patches.surface, patches.area)
means = np.array([np.bincount(patches.surface, patches.area * run) / area for run in runs])
low, high = (end[:, 0] for end in walk.surface_interval(0.68))
error = np.hypot(means.std(axis=0, ddof=1) / 6**0.5, (high - low) / 2)
print(np.abs((means.mean(axis=0) - (low + high) / 2) / error).max(), (error / low).max())
"""
    out = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, check=True, cwd=BENCHMARKS
    ).stdout
    off, error = map(float, out.split())
    assert off < 5
    assert error < 0.01  # else it would tell nothing
