"""Contract 3: bands ride on the integers; none of their power is left behind."""

import numpy as np
import pytest
from enclosures import cube

import radiosity as rd
from radiosity.problem.bands import BandGroups

COLORS = [[0.8, 0.5, 0.1], [0.2, 0.5, 0.7], [0.6, 0.3, 0.3], [0.1, 0.7, 0.2], [0.5, 0.5, 0.6], [0.3, 0.3, 0.75]]
LIGHT = [[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [0.0, 0.0, 0.0], [0.0, 0.2, 0.9], [0.0, 0.0, 0.0]]


def total(solution):
    return solution.patches.area @ solution.irradiance


def alone(scene, band):
    one = rd.Scene.from_arrays(scene.vertices, scene.faces, scene.reflectance[:, band], scene.emission[:, band])
    return one


def test_no_power_is_left_behind_at_five_lines_a_patch():
    """Dividing by the lines fired instead loses a tenth. The bound is four standard errors of 64 random replicates."""
    patches = rd.subdivide(cube(COLORS, LIGHT), cells=20)
    few = rd.solve(patches, quanta=4_500, replicates=64, numbers="random")
    assert 4 < few.rays / few.replicates / len(patches) < 7
    many = rd.solve(patches, "random-walk", rays=10_000_000, replicates=8)
    assert np.abs(total(few) / total(many) - 1).max() < 0.005


def test_each_band_is_its_own_problem():
    patches = rd.subdivide(cube(COLORS, LIGHT), cells=4)
    together = rd.solve(patches, "random-walk", rays=4_000_000, replicates=16)
    for band in range(3):
        single = rd.solve(rd.subdivide(alone(patches.scene, band), cells=4), "random-walk", rays=4_000_000, replicates=16, seed=9)
        error = np.hypot(together.irradiance_standard_error[:, band], single.irradiance_standard_error[:, 0])
        z = (together.irradiance[:, band] - single.irradiance[:, 0]) / error
        assert np.abs(z).max() < 6.5  # 96 patches, Student with about 30 degrees of freedom
        assert 0.7 < np.sqrt(np.mean(z**2)) < 1.4


def test_equal_bands_are_computed_once_and_are_the_integers():
    grey = rd.solve(rd.subdivide(cube(0.5, 1.0), cells=4), "random-walk", quanta=50_000)
    tinted = cube([[0.5, 0.5, 0.5]], [[1.0, 0.25, 0.0]])
    groups = BandGroups.of(rd.subdivide(tinted, cells=4))
    assert groups.n_groups == 1
    solution = rd.solve(rd.subdivide(tinted, cells=4), "random-walk", quanta=50_000)
    assert np.array_equal(solution.state["arrivals"], grey.state["arrivals"])
    assert np.allclose(solution.irradiance, grey.irradiance * [1.0, 0.25, 0.0], rtol=1e-12)


@pytest.mark.parametrize(
    ("emission", "reflectance", "groups"),
    [
        (([1, 1], [1, 1.005]), ([0.5, 0.5], [0.5, 0.5]), 2),
        (([1, 1], [1, 1 + 1e-9]), ([0.5, 0.5], [0.5, 0.5]), 2),
        (([1, 1], [1.005, 1.005]), ([0.5, 0.5], [0.5, 0.5]), 1),
        (([1, 3], [0.1, 0.3]), ([0.5, 0.2], [0.5, 0.2]), 1),
        (([1, 0], [1, 1e-9]), ([0.5, 0.5], [0.5, 0.5]), 2),
        (([1, 0], [0, 1]), ([0.5, 0.5], [0.5, 0.5]), 2),
        (([1, 1], [2, 2]), ([0.5, 0.5], [0.5, 0.5 + 1e-12]), 2),
        (([1, 1], [0, 0]), ([0.5, 0.5], [0.1, 0.9]), 1),  # dark: any group times zero
        (([0, 0], [1, 1]), ([0.5, 0.5], [0.1, 0.9]), 1),
        (([1, 2], [3, 4], [2, 4], [1.5, 2]), 4 * ([0.5, 0.2],), 2),
    ],
)
def test_bands_are_one_group_where_one_is_a_multiple_of_the_other(emission, reflectance, groups):
    """Two lamps in bands, (n_bands, 2) here: what the groups say of each band is the band."""
    corners = [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2, 3], [7, 6, 5, 4]], np.transpose(reflectance), np.transpose(emission))
    found = BandGroups.of(rd.subdivide(scene, cells=1))
    assert found.n_groups == groups
    np.testing.assert_allclose(found.emission[:, found.index] * found.scale, scene.emission, rtol=1e-14, atol=0)
    lit = scene.emission.any(axis=0)
    np.testing.assert_array_equal(found.reflectance[:, found.index[lit]], scene.reflectance[:, lit])


def test_lamps_that_differ_by_half_a_percent_stay_apart():
    """Each lights the other: one receives the same in both bands, the other half a percent more in the second."""
    light = np.zeros((6, 2))
    light[4], light[5] = [1, 1], [1, 1.005]
    solution = rd.solve(rd.subdivide(cube(0.0, light), cells=1), quanta=1 << 16, replicates=2, numbers="sobol")
    lower, upper = solution.irradiance[4], solution.irradiance[5]  # each is lit by the other
    assert upper[1] == pytest.approx(upper[0], rel=1e-3)
    assert lower[1] == pytest.approx(1.005 * lower[0], rel=1e-3)


def test_the_integers_are_those_of_the_largest_band():
    scene = cube(COLORS, LIGHT)
    largest = rd.Scene.from_arrays(scene.vertices, scene.faces, scene.reflectance.max(axis=1), scene.emission.max(axis=1))
    colored, grey = (rd.solve(rd.subdivide(s, cells=4), "random-walk", quanta=50_000) for s in (scene, largest))
    assert np.array_equal(colored.state["arrivals"], grey.state["arrivals"])
    assert np.array_equal(colored.state["fired"], grey.state["fired"])


def test_books_of_every_band_close():
    solution = rd.solve(rd.load_scene("cornell-box"), "random-walk", rays=200_000, replicates=3)
    for band, book in enumerate(solution.books):
        assert book["closes"]
        left = book["emitted"] + book["rounding"]
        assert left == pytest.approx(book["absorbed"] + book["escaped"] + book["lost"], rel=1e-12)
        assert abs(book["rounding"]) < 2e-3 * book["emitted"]
        emitted = solution.patches.area @ solution.patches.emission[:, band]
        assert book["emitted"] == pytest.approx(emitted, rel=1e-9)


def test_threads_do_not_change_band_power():
    import drjit as dr

    patches, before, results = rd.subdivide(cube(COLORS, LIGHT), cells=6), dr.thread_count(), []
    try:
        for threads in (1, 2):
            dr.set_thread_count(threads)
            results.append(rd.solve(patches, "random-walk", quanta=30_000).irradiance)
    finally:
        dr.set_thread_count(before)
    assert np.array_equal(*results)


def test_depth_first_refuses_different_bands():
    with pytest.raises(rd.MethodError, match=r"3 different bands.*breadth-first"):
        rd.solve(cube(COLORS, LIGHT), rays=1000, order="depth-first")
