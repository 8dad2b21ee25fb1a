"""Form factors from counted lines: against closed forms and the firing engine, in standard errors of the replicates.

About 60 comparisons at 5 to 6.5 standard errors (Student with 15 degrees of freedom or more: p below 2e-4 at 5) leave a chance of
about 1 % for a false alarm, and seeds are fixed.
"""

import numpy as np
import pytest
from enclosures import coaxial_discs, cube, parallel_squares, sphere_in_box
from iterations import walked
from replicates import difference, powers

import radiosity as rd
from radiosity.algorithms.matrix.tally import MatrixTally
from radiosity.factors.counted import CountedPairs
from radiosity.factors.counts import PairCounts, split
from radiosity.patches.scatter import Scatter

LINES = ("local", "global", "global-disc", "spans", "bundles")
GLOBAL = LINES[1:]


def counted(solution: rd.Solution, *, both_ways: bool) -> CountedPairs:
    """What a run counted."""
    state = solution.state
    return CountedPairs(solution.patches, state["keys"], state["counts"], int(state["replicates"]), both_ways)


@pytest.mark.parametrize("lines", LINES)
def test_exact_form_factors_of_discs(lines):
    scene, exact = coaxial_discs()
    patches = rd.subdivide(scene, cells=1)
    solution = rd.solve(patches, rd.Method(order="matrix", lines=lines), rays=1_000_000, replicates=16)
    factors = counted(solution, both_ways=lines == "local").between(patches.surface)
    error = factors[:, 0, 1].std(ddof=1) / 4
    assert abs(factors[:, 0, 1].mean() - exact) < 5 * error
    assert error < 0.02 * exact
    assert np.allclose(factors.sum(axis=2), 1, atol=1e-12)  # what does not land escapes or is lost
    assert (factors[:, 0, 0] == 0).all()  # a plane does not see itself


@pytest.mark.parametrize("lines", LINES)
def test_exact_form_factors_of_a_sphere_in_a_box(lines):
    scene, exact = sphere_in_box()
    patches = rd.subdivide(scene, cells=1)
    solution = rd.solve(patches, rd.Method(order="matrix", lines=lines), rays=1_000_000, replicates=16)
    factors = counted(solution, both_ways=lines == "local").between(patches.surface)
    assert np.allclose(factors[:, 0], [0, 1, 0, 0], atol=1e-5)  # sphere: all to the box, but what slips through an edge
    error = factors[:, 1, 0].std(ddof=1) / 4
    assert abs(factors[:, 1, 0].mean() - exact) < 5 * error
    assert error < 0.01 * exact


@pytest.mark.parametrize("mean_reflectance", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("lines", ["local", "global", "global-disc", "spans"])
def test_the_furnace_is_exact_since_rows_sum_to_one(mean_reflectance, lines):
    patches = rd.subdivide(rd.load_scene(f"labyrinth-{mean_reflectance}"), cells=1)
    solution = rd.solve(patches, rd.Method(order="matrix", lines=lines), rays=400_000, replicates=4)
    assert np.abs(solution.radiosity - 1).max() < 1e-8
    assert abs(solution.rays / 400_000 - 1) < 0.05


@pytest.mark.parametrize("lines", LINES)
@pytest.mark.parametrize("scene", ["room", "open", "two-sided"])
def test_surfaces_receive_what_the_firing_engine_says(reference, scene, lines):
    patches, expected = reference[scene]
    solution = rd.solve(patches, rd.Method(order="matrix", lines=lines), rays=1_000_000, replicates=16, seed=3)
    power = powers(solution, tally=MatrixTally(lines == "local"))
    # what a patch gets back of its own light goes there and back along counts of the same lines: a bias of the order of one
    # over the lines of the patch, which the light's few lines show
    patch_lines = solution.rays / 16 * np.array([patches.area[patches.surface == s].mean() for s in np.unique(patches.surface)])
    bias = 8 * patches.area.sum() / patch_lines * power.mean(axis=0)
    close = np.abs(power.mean(axis=0) - expected.mean(axis=0)) < bias
    assert ((np.abs(difference(power, expected)) < 6.0) | close).all()
    book = solution.books[0]
    assert book["closes"] is None
    assert abs(book["rounding"]) < (1e-4 if lines == "local" else 0.05) * book["emitted"]


@pytest.fixture(scope="module")
def reference():
    return walked()


def test_both_ways_is_reciprocal_and_better():
    """Of the room, with random numbers: factors between patches, and the error of the solution.

    By Poisson's distribution a row alone finds A_i F_ij with the variance A_i F_ij / w_i, where w_i are its lines over its area,
    and both rows together with A_i F_ij / (w_i + w_j): so much smaller is the spread over replicates, pair by pair.
    """
    patches = rd.subdivide(rd.load_scene("room"), cells=1)
    n, area = len(patches), patches.area
    solution = rd.solve(patches, rd.Method(order="matrix", numbers="random"), rays=1_000_000, replicates=32)
    each = np.arange(n)
    both, rows = (counted(solution, both_ways=b).between(each) for b in (True, False))
    exchange = area[:, None] * both[:, :, :-2]
    assert np.abs(exchange - exchange.transpose(0, 2, 1)).max() < 1e-4 * area.max()
    for factors in (both, rows):
        assert factors.sum(axis=2) == pytest.approx(np.ones((32, n)), rel=1e-12)
    assert np.array_equal(both[:, :, -2:] > 0, rows[:, :, -2:] > 0)  # scaled, with its row
    found = np.abs(difference(both.reshape(32, -1), rows.reshape(32, -1)).reshape(n, n + 2))
    assert found.max() < 6
    keys, counts = split(solution.state["keys"])[0] % n, solution.state["counts"]
    weight = np.bincount(keys, counts, n) / area
    often = np.minimum(rows.mean(axis=0)[:, :-2], rows.mean(axis=0)[:, :-2].T) * np.bincount(keys, counts, n)[:, None] > 300
    assert often.sum() > 50
    spread, alone = (x.std(axis=0, ddof=1)[:, :-2][often] for x in (both, rows))
    expected = np.sqrt(weight[:, None] / (weight[:, None] + weight))[often]
    assert np.sqrt(np.mean((spread / alone / expected) ** 2)) == pytest.approx(1, abs=0.12)  # scaling takes and gives a little
    one, other = (powers(solution, tally=MatrixTally(b)).std(axis=0) for b in (True, False))
    assert np.mean(one) < 0.2 * np.mean(other)


@pytest.mark.parametrize("lines", ["local", "spans"])
def test_what_was_counted_solves_for_other_light(lines):
    """Prepared once, in a room; solved for another lamp and other walls, without a line more: as the firing engine says, and
    linear in emission to rounding."""
    patches = rd.subdivide(rd.load_scene("room"), cells=2)
    pairs = counted(
        rd.solve(patches, rd.Method(order="matrix", lines=lines), rays=1_000_000, replicates=16), both_ways=lines == "local"
    )
    scene = patches.scene
    wall = (scene.emission[:, 0] == 0) & (scene.area == scene.area[scene.emission[:, 0] == 0].max())
    other = rd.Scene.from_arrays(scene.vertices, scene.faces, 0.35, np.where(wall, 7.0, 0.0), back=scene.back)
    cut = rd.subdivide(other, cells=2)
    assert np.allclose(cut.area, patches.area)
    (found,) = pairs.solve(cut.emission, cut.scatter)
    wanted = rd.solve(cut, "random-walk", rays=4_000_000, replicates=16, seed=4)
    values, reference = found.power / cut.area, wanted.irradiance[:, 0]
    error = np.hypot(values.std(axis=0, ddof=1) / 4, wanted.irradiance_standard_error[:, 0])
    off = np.abs(values.mean(axis=0) - reference)
    assert (off < 6 * error + found.bias.mean(axis=0) / cut.area + 1e-6 * reference.max()).all()
    assert (off < 0.05 * reference.max()).all()
    both = pairs.solve(
        np.hstack([cut.emission, 3 * cut.emission + patches.emission, patches.emission]),
        Scatter(np.repeat(cut.reflectance, 3, axis=1)),
    )
    assert np.allclose(both[1].power, 3 * both[0].power + both[2].power, rtol=1e-8)
    assert np.array_equal(both[0].power, found.power)


def test_colours_share_the_factors():
    colors = [[0.8, 0.5, 0.1], [0.2, 0.5, 0.7], [0.6, 0.3, 0.3], [0.1, 0.7, 0.2], [0.5, 0.5, 0.6], [0.3, 0.3, 0.75]]
    light = [[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [0.0, 0.0, 0.0], [0.0, 0.2, 0.9], [0.0, 0.0, 0.0]]
    scene = cube(colors, light)
    patches = rd.subdivide(scene, cells=4)
    together = rd.solve(patches, rd.Method(order="matrix"), rays=1_000_000, replicates=16)
    firing = rd.solve(patches, "random-walk", rays=4_000_000, replicates=16)
    z = (together.irradiance - firing.irradiance) / np.hypot(together.irradiance_standard_error, firing.irradiance_standard_error)
    assert np.abs(z).max() < 6.5
    assert 0.7 < np.sqrt(np.mean(z**2)) < 1.4


def test_counts_are_those_of_a_dictionary(random):
    from collections import Counter

    counts, expected = PairCounts(), Counter()
    for size in (0, 1, 1000, 50_000):
        rows, columns = random.integers(0, 40, size), random.integers(0, 50, size)
        counts.add(rows, columns)
        expected.update(zip(rows.tolist(), columns.tolist(), strict=True))
    keys, numbers = counts.arrays
    assert (np.diff(keys.astype(np.int64)) > 0).all()
    assert dict(zip(zip(*(x.tolist() for x in split(keys)), strict=True), numbers.tolist(), strict=True)) == dict(expected)


def test_too_many_pairs_are_refused_or_end_the_run(monkeypatch):
    from radiosity.algorithms.matrix import algorithm as matrix

    patches = rd.subdivide(rd.load_scene("room"), cells=6)
    monkeypatch.setattr(matrix, "LIMIT", 1000)
    with pytest.raises(rd.MethodError, match=r"648 patches in 8 replicates.*fewer replicates"):
        rd.solve(patches, rd.Method(order="matrix"), quanta=5_000)
    monkeypatch.setattr(matrix, "LIMIT", 1_060_000)
    solution = rd.solve(patches, rd.Method(order="matrix"), quanta=10**6)
    assert "may come to" in solution.status
    assert solution.quanta < 10**6


@pytest.fixture(scope="module")
def passing():
    """The room whose backs let lines pass, and what its surfaces receive from random walks."""
    from dataclasses import replace

    scene = rd.load_scene("room")
    patches = rd.subdivide(replace(scene, back=np.full_like(scene.back, int(rd.Back.PASSES))), cells=3)
    return patches, powers(rd.solve(patches, "random-walk", rays=4_000_000, replicates=16))


@pytest.mark.parametrize("lines", LINES)
def test_backs_that_let_lines_pass_are_counted_one_way(passing, lines):
    patches, expected = passing
    solution = rd.solve(patches, rd.Method(order="matrix", lines=lines), rays=2_000_000, replicates=16)
    assert np.abs(difference(powers(solution, tally=MatrixTally(False, directed=True)), expected)).max() < 6.0


@pytest.mark.parametrize("lines", LINES)
def test_light_goes_through_backs_that_pass_although_it_does_not_come_back(lines):
    """Between two facing squares stands a wide screen whose back lets the light of the lower one pass, and whose front hides that
    one from the upper. The upper square receives what it would without the screen, which receives nothing."""
    below, exact = parallel_squares()
    screen = [(-5, -5, 0.5), (6, -5, 0.5), (6, 6, 0.5), (-5, 6, 0.5)]
    scene = rd.Scene.from_arrays(
        np.concatenate([below.vertices, screen]),
        np.concatenate([below.faces, [[8, 9, 10, 11]]]),
        0.0,
        [1.0, 0.0, 0.0],
        back=[rd.Back.ABSORBS, rd.Back.ABSORBS, rd.Back.PASSES],
        surface=range(3),
        names=["lamp", "square", "screen"],
    )
    solution = rd.solve(rd.subdivide(scene, cells=1), rd.Method(order="matrix", lines=lines), rays=1_000_000, replicates=16)
    power = powers(solution, key=np.arange(3))
    error = power[:, 1].std(ddof=1) / 4
    assert abs(power[:, 1].mean() - exact) < 5 * error
    assert error < 0.05 * exact
    assert (power[:, [0, 2]] == 0).all()
