"""Inputs on which other programs give wrong view factors (docs/view-factors.md): ours are right there."""

import numpy as np
import pytest

import radiosity as rd
from benchmarks.heat_formulas import grouped, square, weighted
from benchmarks.heat_scene import CUTS, mesh, parents
from validation.closed_forms.rectangles import parallel, perpendicular

FLOOR = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


def factors(*quads, rays=200_000, method="polygons", seed=0, replicates=8):
    corners = np.array(quads, float)
    scene = rd.Scene.from_arrays(
        corners.reshape(-1, 3), np.arange(4 * len(quads)).reshape(-1, 4), 0.5, 0.0, surface=np.arange(len(quads))
    )
    return rd.view_factors(scene, rays=rays, method=method, seed=seed, replicates=replicates)


@pytest.mark.parametrize("method", ["lines", "polygons"])
def test_what_lies_behind_a_face_counts_nothing(method):
    found = factors(FLOOR, [[0, 1, -0.8], [0, 1, 1], [0, 0, 1], [0, 0, -0.8]], method=method)
    assert found.matrix[0, 1] == pytest.approx(perpendicular(1, 1), abs=1e-5 if method == "polygons" else 3e-3)


@pytest.mark.parametrize("method", ["lines", "polygons"])
def test_a_screen_of_a_millimetre_hides(method):
    low = np.array(FLOOR) * 1e-3
    screen = (np.array(FLOOR) - [0.1, 0.1, 0]) * [1.2, 1.2, 1] * 1e-3
    found = factors(low, low[::-1] + np.array([0, 0, 1e-3]), screen + np.array([0, 0, 5e-4]), method=method)
    assert found.matrix[0, 1] == 0


def test_rows_send_and_columns_receive():
    large = [[-1.5, -1.5, 1], [-1.5, 2.5, 1], [2.5, 2.5, 1], [2.5, -1.5, 1]]
    found = factors(FLOOR, large)
    assert found.matrix[0, 1] == pytest.approx(16 * found.matrix[1, 0])
    assert found.matrix[0, 1] == pytest.approx(0.82273, abs=1e-4)


def test_seeds_share_no_replicates():
    """Replicate r + 1 of seed 1 is not replicate r of seed 2: of 7, fewer than 4 agree (by chance 1e-3, seeds are fixed)."""
    ceiling = np.array(FLOOR)[::-1] + np.array([0, 0, 1])
    runs = [factors(FLOOR, ceiling, rays=20_000, method="lines", seed=s).samples for s in (1, 2)]
    assert (runs[0][1:] == runs[1][:-1]).all(axis=1).sum() < 4
    assert runs[0].mean(axis=0)[0] == pytest.approx(parallel(1, 1), abs=0.02)


def test_formulas_of_the_benchmark():
    cut, times = CUTS["544"], 2
    fine, coarse, parent = mesh(cut.finer(times)), mesh(cut), parents(cut, times)
    np.testing.assert_allclose(np.bincount(parent, fine.area), coarse.area)
    np.testing.assert_array_equal(coarse.surface[parent], fine.surface)
    exact = np.array([[0, 1, 0], [0.2, 0, 0.8], [0, 1, 0]])
    np.testing.assert_allclose(grouped(exact, np.array([1, 3, 2]), np.array([0, 0, 1])), [[0.4, 0.6], [1, 0]])
    assert square(1.1 * exact, exact) == pytest.approx(0.01)
    mean, variance = weighted([np.array(1.0), np.array(4.0)], [1.0, 2.0])
    assert (mean, variance) == (pytest.approx(2.0), pytest.approx(2 / 3))
