"""The statistics of referees: they find what is there, and nothing else."""

import numpy as np
import pytest

import radiosity as rd
from validation.comparison import ALPHA, Value, patchwise, together
from validation.runs import Runs

RUNS, SPREAD = 16, 0.1


@pytest.fixture(scope="module")
def patches():
    return rd.subdivide(rd.load_scene("room"), cells=1)


def noisy(patches, generator, bias=0.0, share=0.0):
    """Runs about one, with standard errors as they are; a ``share`` of their noise is common to all patches of a run."""
    n = len(patches)
    own, common = generator.normal(size=(RUNS, n, 1)), generator.normal(size=(RUNS, 1, 1))
    values = 1 + bias + SPREAD * (np.sqrt(1 - share) * own + np.sqrt(share) * common)
    stated = SPREAD * np.sqrt(generator.chisquare(24, size=(RUNS, n, 1)) / 24)
    return Runs(patches, values, stated, 0.0)


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_p_values_are_uniform_without_a_difference(patches, random, share):
    exact = np.ones((len(patches), 1))
    found = np.array([patchwise("", noisy(patches, random, share=share), exact, seed=i).p for i in range(40)])
    # 40 uniform values: Kolmogorov's distance beyond 0.31 has a chance of 1e-3
    assert np.abs(np.sort(found) - (np.arange(40) + 0.5) / 40).max() < 0.31 - 0.5 / 40


def test_a_bias_is_found_where_errors_are_independent(patches, random):
    exact = np.ones((len(patches), 1))
    # two standard errors of each patch's mean: chi-square per patch is 1 + 2², of 18 patches give or take 1.1
    off = patchwise("", noisy(patches, random, bias=2 * SPREAD / np.sqrt(RUNS)), exact)
    assert off.chi_square == pytest.approx(5, abs=3.3)
    assert off.p < ALPHA
    assert not off.agrees
    assert off.mean[0] == pytest.approx(2 * SPREAD / np.sqrt(RUNS), abs=5 * off.mean[1])


def test_one_patch_that_is_off_is_found(patches, random):
    runs = noisy(patches, random)
    runs.irradiance[:, 7] += 10 * SPREAD / np.sqrt(RUNS)
    assert patchwise("", runs, np.ones((len(patches), 1))).worst[1] < ALPHA


def test_stated_errors_that_are_too_small_are_seen(patches, random):
    runs = noisy(patches, random)
    half = Runs(patches, runs.irradiance, runs.stated / 2, 0.0)
    found = patchwise("", half, np.ones((len(patches), 1)))
    assert found.expected == pytest.approx(4, rel=0.2)
    assert found.p > ALPHA  # the mean is right all the same


def test_noise_of_the_other_side_counts(patches, random):
    theirs = 1 + 3 * SPREAD * random.normal(size=(RUNS, len(patches), 1))
    found = patchwise("", noisy(patches, random), theirs)
    assert found.rms[1] == pytest.approx(np.sqrt(10) * SPREAD / np.sqrt(RUNS), rel=0.1)
    assert found.agrees


def test_what_is_allowed_is_added_to_the_variance(patches, random):
    bias = 4 * SPREAD / np.sqrt(RUNS)
    runs, exact = noisy(patches, random, bias=bias), np.ones((len(patches), 1))
    assert not patchwise("", runs, exact).agrees
    assert patchwise("", runs, exact, discretisation=np.full(exact.shape, bias)).agrees


def test_patches_without_a_stated_error_must_be_equal(patches, random):
    runs = noisy(patches, random)
    runs.stated[:, 3] = 0
    with pytest.raises(ValueError, match="without stated errors"):
        patchwise("", runs, np.ones((len(patches), 1)))


def test_values(random):
    values = 2 + 0.1 * random.normal(size=16)
    assert Value.of("", 2.0, values).p > ALPHA
    assert Value.of("", 2.5, values).p < ALPHA
    assert Value.of("", 2.5, values, bound=0.5).p > ALPHA
    assert Value.of("", 1.0, np.ones(16)).p == 1
    with np.errstate(divide="ignore"):
        assert Value.of("", 1.1, np.ones(16)).p == 0
    many = [Value.of("", 0.0, random.normal(size=16)).p for _ in range(40)]
    assert together(many) > ALPHA
    assert together([p / 5 for p in many]) < ALPHA
