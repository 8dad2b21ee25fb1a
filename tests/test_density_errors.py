"""Density estimation is held to its own error bars, which hold its bias; and power stays on the surface where it landed."""

from functools import cache

import numpy as np
import pytest
from enclosures import cube
from replicates import powers

import radiosity as rd
from radiosity.solution.smoothing import Smoother

SEEDS = 4
COVERED = 1.3  # RMS of errors over stated errors: that of Student's t of 8 replicates is sqrt(7 / 5) = 1.18


@pytest.fixture(scope="module")
def room():
    """Patches, and their irradiance by counting ten times as many lines."""
    patches = rd.subdivide(rd.load_scene("room"), cells=24)
    return patches, cache(lambda rays: rd.solve(patches, "particle-tracing", rays=10 * rays, seed=50))


def rms(room, rays: int) -> tuple[float, float]:
    """Of (value - truth) / stated error over the patches and seeds; and RMS error over RMS stated error of the whole scene."""
    patches, truth = room[0], room[1](rays)
    z, squares = [], np.zeros(2)
    for seed in range(SEEDS):
        solution = rd.solve(patches, "density-estimation", rays=rays, seed=seed)
        error = (solution.irradiance - truth.irradiance)[:, 0]
        stated = np.hypot(solution.irradiance_standard_error, truth.irradiance_standard_error)[:, 0]
        seen = solution.arrivals > 0
        z.append(error[seen] / stated[seen])
        squares += patches.area @ error**2, patches.area @ stated**2
    return float(np.sqrt(np.mean(np.concatenate(z) ** 2))), float(np.sqrt(squares[0] / squares[1]))


@pytest.mark.parametrize("rays", [1_000_000, pytest.param(8_000_000, marks=pytest.mark.slow)])
def test_stated_errors_cover_the_truth(room, rays):
    """No p-value, since neighbours err together. Single seeds give 0.05 more or less: bounds are several times that away."""
    patch, scene = rms(room, rays)
    assert 0.8 < patch < COVERED
    assert 0.75 < scene < 1.2


@pytest.mark.slow
def test_stated_errors_without_the_bias_are_rejected(room, monkeypatch):
    monkeypatch.setattr(Smoother, "bias", lambda self, power, smoothed: np.zeros(power.shape[1]))
    patch, scene = rms(room, 8_000_000)
    assert patch > 1.4 * COVERED
    assert scene > 1.2


@pytest.mark.parametrize("scene", ["room", "cornell-box"])
def test_surfaces_receive_what_was_counted(scene):
    patches = rd.subdivide(rd.load_scene(scene), cells=8)
    for rays in (60_000, 500_000):
        fitted, counted = (rd.solve(patches, m, rays=rays, seed=3) for m in ("density-estimation", "particle-tracing"))
        assert powers(fitted) == pytest.approx(powers(counted), rel=1e-9)
        assert fitted.books[0]["absorbed"] == pytest.approx(counted.books[0]["absorbed"], rel=1e-9)


@pytest.fixture(scope="module")
def walls():
    return rd.subdivide(cube(), cells=12)


def test_the_bias_of_a_step_is_found_where_it_is(walls):
    """Without noise: the squared bias averaged over a wall is the true one, and far from the step there is none."""
    smoother = Smoother.of(walls, np.full(len(walls), 100))
    step = np.where(walls.centroid[:, 0] > 0.5, 2.0, 1.0) * walls.area
    power = np.stack([step, step])
    smoothed = smoother.smooth(power)
    bias = smoother.bias(power, smoothed)
    crossed = (np.ptp(walls.scene.vertices[walls.scene.faces], axis=1)[:, 0] > 0.5)[walls.face]
    assert np.sqrt(np.mean(bias[crossed] ** 2)) == pytest.approx(np.sqrt(np.mean((smoothed[0] - step)[crossed] ** 2)), rel=0.1)
    far = crossed & (np.abs(walls.centroid[:, 0] - 0.5) > 2.2 * smoother.regions.bandwidth(np.full(len(walls), 100)).max())
    assert far.any()
    assert bias[far].max() < 0.03 * bias.max()


def test_noise_is_not_taken_for_bias(walls, random):
    """An even wall: what is stated as bias stays below the standard error of the fit."""
    smoother = Smoother.of(walls, np.full(len(walls), 100))
    power = random.poisson(12, (8, len(walls))) * walls.area / 12
    smoothed = smoother.smooth(power)
    error = smoothed.std(axis=0, ddof=1) / 8**0.5
    assert np.sqrt(np.mean(smoother.bias(power, smoothed) ** 2)) < np.sqrt(np.mean(error**2))


def test_the_bias_of_one_replicate_is_unknown(walls):
    smoother = Smoother.of(walls, np.full(len(walls), 100))
    power = walls.area[None]
    assert np.isnan(smoother.bias(power, smoother.smooth(power))).all()
