"""What the study computes from errors: slopes, ratios, deviations and coverages, of numbers that are known."""

from types import SimpleNamespace

import numpy as np
import pytest
from enclosures import cube
from scipy import stats

import radiosity as rd
from radiosity.lab import calibration, contest, discretisation, measure, slopes, varying
from radiosity.lab.sight import Sight
from radiosity.patches.nesting import parents
from radiosity.scene.shapes import quad


def test_a_slope_is_that_of_the_last_two_decades():
    """Steeper at the start, which does not count; each replicate has a slope of its own, and the interval is Student's."""
    lines = 2.0 ** np.arange(10, 24)
    last = lines >= lines[-1] / 100
    own = np.array([-0.5, -0.6, -0.75])
    errors = 7 * lines ** own[:, None]
    errors[:, ~last] = 7 * lines[~last] ** -3.0
    found = slopes.fit(lines, errors)
    assert found.value == pytest.approx(own.mean(), rel=1e-12)
    assert found.half == pytest.approx(stats.t.ppf(0.975, 2) * own.std(ddof=1) / np.sqrt(3), rel=1e-12)
    assert (found.low, found.high) == (found.value - found.half, found.value + found.half)
    assert last.sum() == 7
    assert not last[-8]
    assert np.isnan(slopes.fit(lines[-2:], errors[:, -2:]).value)  # two points tell nothing


def test_errors_of_zero_are_left_out_of_slopes():
    lines = 2.0 ** np.arange(10, 20)
    errors = np.tile(lines**-0.5, (2, 1))
    errors[1, -1] = 0.0
    assert slopes.fit(lines, errors).value == pytest.approx(-0.5)


def test_ratios_are_of_the_last_rung_the_first_over_the_second():
    one, other = np.array([[9.0, 2.0], [9.0, 8.0]]), np.array([[9.0, 1.0], [9.0, 1.0], [9.0, 1.0]])
    value, factor = slopes.ratio(one, other)
    assert value == pytest.approx(4.0)  # the geometric mean of 2 and 8
    spread = np.log(one[:, -1]).std(ddof=1) / np.sqrt(2)
    assert factor == pytest.approx(np.exp(stats.t.ppf(0.975, 3) * spread))
    assert slopes.ratio(other, one)[0] == pytest.approx(1 / 4)
    assert slopes.mean_error(np.array([[3.0, 1.0], [4.0, 1.0]])) == pytest.approx([np.sqrt(12.5), 1.0])


def test_errors_of_bases_are_those_of_a_linear_field():
    """Light 1 + u over each face: linear coefficients leave nothing, means the square of u - 1/2 at the middles of fine cells."""
    scene = cube(0.5, 1.0)
    fine, coarse = rd.subdivide(scene, cells=8), rd.subdivide(scene, cells=2)
    column, _, _ = fine.place
    light = 1 + (column + 0.5)[:, None] / 8
    truth = varying.Truth(fine, light, np.zeros_like(light))
    moments = np.zeros((2, len(coarse), 1, 3))
    moments[:, :, 0, 0] = 1 + (coarse.place[0] + 0.5) / 2
    moments[0, :, 0, 1] = 1 / (4 * np.sqrt(3))
    without = np.sqrt(np.mean((light[:, 0] - moments[0, parents(fine, coarse), 0, 0]) ** 2) / np.mean(light**2))
    assert truth.errors(coarse, "linear", moments) == pytest.approx([0, without], abs=1e-7)
    assert truth.errors(coarse, "constant", moments[1:, :, :, :1]) == pytest.approx([without])


def test_deviations_are_relative_to_the_reflected_light():
    area, emission = np.array([1.0, 3.0]), np.array([[0.0], [10.0]])
    case = SimpleNamespace(patches=SimpleNamespace(area=area, emission=emission))
    truth, found = np.array([2.0, 11.0]), np.array([[2.5, 11.0], [2.0, 12.0]])
    absolute = measure.deviations(case, found, truth, absolute=True)
    assert absolute[0] == pytest.approx([0.5 * np.sqrt(1 / 4), np.sqrt(3 / 4)])  # weighted by area
    assert absolute[1] == pytest.approx([0.5 * np.sqrt(1 / 2), np.sqrt(1 / 2)])  # and plain
    relative = measure.deviations(case, found, truth, absolute=False)
    assert relative[0] == pytest.approx(absolute[0] / np.sqrt((1 * 2.0**2 + 3 * 1.0**2) / 4))
    assert relative[1] == pytest.approx(absolute[1] / np.sqrt((2.0**2 + 1.0**2) / 2))


def test_errors_of_a_contest_are_the_worst_band_s():
    area, truth = np.array([1.0, 3.0]), np.array([[1.0, 2.0], [1.0, 2.0]])
    found = truth + np.array([[0.0, 0.2], [0.03, 0.0]])
    bands = [np.sqrt(3 * 0.03**2 / 4), np.sqrt(0.2**2 / (4 * 2.0**2))]
    assert contest._error(found, truth, area) == pytest.approx(max(bands))
    assert contest._error(found[:, ::-1], truth[:, ::-1], area) == pytest.approx(max(bands))


def test_coverage_and_its_error_are_over_runs(monkeypatch):
    """Of made-up radiosities: normal about the truth in each replicate. The share of patches covered varies from run to run."""
    patches = rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1)
    random, n, seeds = np.random.Generator(np.random.Philox(3)), len(patches), 200
    values = 5 + random.normal(size=(seeds * calibration.REPLICATES, n))
    monkeypatch.setattr(calibration, "radiosity", lambda *_: values)
    arm = SimpleNamespace(name="made up", method=rd.Method())
    case = SimpleNamespace(patches=patches, name="labyrinth")
    found = calibration.coverage(arm, case, np.full(n, 5.0), 0, lines=10, seeds=seeds)
    runs = values.reshape(seeds, calibration.REPLICATES, n)
    apart = np.abs(runs.mean(axis=1) - 5) / (runs.std(axis=1, ddof=1) / np.sqrt(calibration.REPLICATES))
    for level, (share, error) in zip(calibration.LEVELS, found.covered, strict=True):
        inside = (apart <= stats.t.ppf(0.5 + level / 2, calibration.REPLICATES - 1)).mean(axis=1)
        assert share == pytest.approx(inside.mean(), rel=1e-12)
        assert error == pytest.approx(inside.std(ddof=1) / np.sqrt(seeds), rel=1e-12)
        assert abs(share - level) < 5 * error
    assert found.rms == pytest.approx(1 / np.sqrt(calibration.REPLICATES), rel=0.02)
    assert found.visited == 1


def test_noise_is_no_discretisation_error(monkeypatch):
    """Made-up radiosities 1 + x off the emission, with noise of every run as large as what is looked for; of 2592 fine and 162
    coarse patches that noise leaves the results uncertain by 3 %, while its mean is 20 % and more."""
    random, truth = np.random.Generator(np.random.Philox(6)), {}

    def solve(patches, method, *, rays, seed):
        noise = 0.3 if truth else 0.5
        truth.setdefault("patches", patches)  # the fine mesh is solved first
        mean = patches.emission[:, 0] + 1 + patches.centroid[:, 0]
        radiosity = mean + noise * random.normal(size=len(mean))
        return SimpleNamespace(radiosity=radiosity[:, None], standard_error=np.full((len(mean), 1), noise))

    def delta(scene, fine, coarse, parent, radiosity, random):
        return 0.5 + 0.3 * random.normal(size=len(fine))

    monkeypatch.setattr("radiosity.run.solve.solve", solve)
    monkeypatch.setattr(discretisation, "delta", delta)
    found = discretisation.discretisation(3, 1.0, 2)
    fine, coarse = truth["patches"], rd.subdivide(rd.load_scene("room"), cells=3)
    inside = fine.centroid[:, 0] - coarse.centroid[parents(fine, coarse), 0]
    size = np.sqrt(fine.area @ (1 + fine.centroid[:, 0]) ** 2)
    assert found.patches == len(coarse)
    for error in (found.discrete, found.continuous):
        assert error == pytest.approx(np.sqrt(fine.area @ inside**2) / size, rel=0.1)
    assert found.delta == pytest.approx(0.5 * np.sqrt(fine.area.sum()) / size, rel=0.05)


def test_pixels_that_see_no_patch_or_the_back_of_one_are_left_out():
    """Of three squares side by side, seen from above, the middle one looks down; beyond them there is nothing."""
    quads = [quad((x, 0, 0), (1, 0, 0), (0, 1, 0)) for x in (0, 1, 2)]
    quads[1] = quads[1][::-1]
    camera = rd.Camera((1.5, 0.5, 10.0), (1.5, 0.5, 0.0), (0, 1, 0), 2 * np.rad2deg(np.arctan(0.1)), 400, 200)  # 4 m x 2 m
    scene = rd.Scene.from_arrays(np.concatenate(quads), np.arange(12).reshape(3, 4), 0.0, [1.0, 2.0, 3.0], cameras=[camera])
    sight = Sight.of(rd.subdivide(scene, cells=1))
    assert np.bincount(sight.patch).tolist() == [1600, 0, 1600]  # a fortieth of a metre to a pixel
    assert sight.error(np.array([[1.0, 5.0, 3.0]]), np.array([1.0, 2.0, 3.0])).tolist() == [0.0]
