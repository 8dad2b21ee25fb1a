"""Closed forms: furnaces, uniform enclosures and exact form factors.

Every bound is in standard errors that the replicates state; with about 30 such comparisons in this file, 4.5 of
them (Student, 15 degrees of freedom: p = 4e-4) leave a chance of about 1 % for a false alarm, and seeds are fixed.
"""

import numpy as np
import pytest
from enclosures import coaxial_discs, cube, parallel_squares, perpendicular_squares, sphere

import radiosity as rd

SIGMAS = 4.5


def area_mean(solution, values):
    return np.average(values, weights=solution.patches.area, axis=0)


def replicate_means(solution):
    """Area mean of irradiance in each replicate."""
    return solution.surface_power[0, :, :, 0].sum(axis=1) / solution.patches.area.sum()


@pytest.mark.parametrize("mean_reflectance", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("numbers", ["halton", "random"])
def test_labyrinth_furnace_is_one_everywhere(mean_reflectance, numbers):
    scene = rd.load_scene(f"labyrinth-{mean_reflectance}")
    solution = rd.solve(rd.subdivide(scene, cells=1), rays=2_000_000, replicates=16, numbers=numbers)
    error = (solution.radiosity - 1) / solution.standard_error
    area = solution.patches.area
    assert (
        np.sqrt(np.average((solution.radiosity[:, 0] - 1) ** 2, weights=area))
        < 0.02 * mean_reflectance / (1 - mean_reflectance) ** 0.5
    )
    assert np.abs(error).max() < 6.5  # the largest of 75, Student with 15 degrees of freedom: p = 75 * 1e-5
    assert 0.75 < np.sqrt(np.mean(error**2)) < 1.5
    assert solution.escaped[0] == 0
    assert solution.books[0]["lost"] == 0


def test_furnace_error_falls_with_lines_and_halton_beats_random():
    patches = rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1)

    def rms(numbers, rays):
        solution = rd.solve(patches, rays=rays, replicates=1, numbers=numbers, seed=3)
        return np.sqrt(np.mean((solution.radiosity - 1) ** 2))

    few, many = rms("halton", 20_000), rms("halton", 2_000_000)
    assert many < few / 10  # slope steeper than -1/2 over two decades
    assert many < 0.7 * rms("random", 2_000_000)


@pytest.mark.parametrize("reflectance", [0.2, 0.8])
@pytest.mark.parametrize("build", [cube, sphere])
def test_uniform_enclosure(build, reflectance):
    solution = rd.solve(rd.subdivide(build(reflectance, 2.0), cells=2), "random-walk", rays=1_000_000, replicates=16)
    exact = 2.0 / (1 - reflectance)
    means = replicate_means(solution)
    error = means.std(ddof=1) / 4
    assert abs(means.mean() - exact) < SIGMAS * error + 1e-5 * exact
    assert error < 2e-3 * exact
    assert area_mean(solution, solution.radiosity)[0] == pytest.approx(2.0 + reflectance * means.mean())
    assert solution.escaped[0] == 0


@pytest.mark.parametrize(("case", "cells"), [(parallel_squares, 3), (perpendicular_squares, 3), (coaxial_discs, 1)])
@pytest.mark.parametrize("numbers", ["halton", "random"])
def test_exact_form_factors(case, cells, numbers):
    scene, exact = case()
    patches = rd.subdivide(scene, cells=cells)
    solution = rd.solve(patches, rays=4_000_000, replicates=16, numbers=numbers)
    receiver = patches.surface == 1
    share = solution.state["arrivals"][:, receiver].sum(axis=1) / solution.quanta
    error = share.std(ddof=1) / 4
    assert abs(share.mean() - exact) < SIGMAS * error
    assert error < 4e-3 * exact  # the discs' symmetric patches share one sequence, hence one error
    assert solution.escaped[0] == pytest.approx((1 - share.mean()) * patches.area[~receiver].sum(), rel=1e-3)
