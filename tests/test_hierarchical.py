"""Hierarchical radiosity against closed forms: factors, push and pull, furnaces, enclosures, growth of links."""

import math
from dataclasses import replace
from itertools import pairwise

import enclosures
import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.hierarchical import REFINEMENTS, Hierarchical, roots, solve_hierarchical
from radiosity.algorithms.hierarchical import refine as refining
from radiosity.algorithms.hierarchical.exchange import Exchange
from radiosity.algorithms.hierarchical.kernel import Shapes, unoccluded
from radiosity.algorithms.hierarchical.levels import Levels
from radiosity.algorithms.hierarchical.oracle import Radiosity
from radiosity.factors.polygons import from_points
from radiosity.patches import Hierarchy, elements

MIXED = rd.Scene.from_arrays(
    [(0, 0, 0), (3, 0, 1), (4, 2, 1), (1, 2, 0), (0, 0, 9)],
    [(0, 1, 2, 3), (0, 1, 4, -1), (1, 2, 4, -1), (3, 2, 1, 0)],
    0.5,
    1.0,
    two_sided=[False, True, False, True],
)


def cut(scene, cells=8):
    return rd.subdivide(scene, cells=cells, powers_of_two=True)


def solved(patches, geometry=None, **parameters):
    return solve_hierarchical(patches, geometry, Hierarchical(**parameters))


def test_push_and_pull_conserve_power(random):
    levels = Levels(Hierarchy(cut(MIXED)))
    patches, every = levels.hierarchy.patches, np.arange(len(levels.hierarchy))
    radiosity, irradiance = random.uniform(size=(len(patches), 3)), random.uniform(size=(len(every), 3))
    pulled = levels.pull(radiosity)
    own = levels.hierarchy.side(levels.leaf)
    power = np.stack([np.bincount(own, band) for band in (radiosity * patches.area[:, None]).T], axis=1)
    root = levels.hierarchy.first[:-1]
    np.testing.assert_allclose(pulled[root] * levels.area[root, None], power, rtol=1e-12)
    np.testing.assert_allclose(pulled[levels.leaf], radiosity)
    pushed = levels.push(irradiance)
    np.testing.assert_allclose((pushed * patches.area[:, None]).sum(axis=0), (irradiance * levels.area[:, None]).sum(axis=0))
    low, high = levels.extremes(radiosity)
    assert (low <= pulled * (1 + 1e-12)).all()
    assert (pulled <= high * (1 + 1e-12)).all()
    assert high[root].max() == radiosity.max()


def test_deviations_are_those_of_the_patch_that_is_farthest_off(random):
    """Whether it is brighter or darker than the element, of each band by itself."""
    levels = Levels(Hierarchy(cut(MIXED)))
    values = random.uniform(size=(len(levels.hierarchy.patches), 3))
    found, expected = Radiosity.of(levels, values), np.zeros((len(levels.hierarchy), 3))
    for patch, element in enumerate(levels.leaf):
        while element >= 0:
            expected[element] = np.maximum(expected[element], np.abs(values[patch] - found.mean[element]))
            element = levels.parent[element]
    np.testing.assert_allclose(found.deviation, expected, atol=1e-14)


@pytest.mark.parametrize("make", [enclosures.parallel_squares, enclosures.perpendicular_squares])
def test_factors_of_whole_squares(make):
    scene, value = make()
    tree = Hierarchy(rd.subdivide(scene, cells=1))
    one, other = (Shapes.of(tree, np.array([i])) for i in (0, 1))
    assert unoccluded(tree, one, other)[0] == pytest.approx(value, rel=2e-4)


def test_factors_are_reciprocal(random):
    tree = Hierarchy(cut(MIXED))
    one, other = (Shapes.of(tree, random.integers(0, len(tree), 500)) for _ in range(2))
    forth, back = unoccluded(tree, one, other) * one.area, unoccluded(tree, other, one) * other.area
    apart = np.abs(one.area / other.area - 1) > 1e-6  # of equal ones the receiver's points are taken
    assert apart.sum() > 200
    np.testing.assert_allclose(forth[apart], back[apart], rtol=1e-12)


def furnace(reflectance: float, cells: int = 8, **parameters) -> float:
    """The largest error in a cube with emission 1 - reflectance, where B is 1 everywhere."""
    result = solved(cut(enclosures.cube(reflectance, 1 - reflectance), cells), **parameters)
    return float(np.abs(result.radiosity - 1).max())


# Emitted power goes as 1 - rho, so epsilon over it asks for like links at each reflectance: of F A_r up to 10^-3 m² (dK up to
# one hundredth, by the radiance norm). Such links leave 3 to 5 % in single rows of factors (measured; 5 % are allowed), and B
# has rho / (1 - rho) times that. With smaller epsilon nothing of it is left: the test after this one.
@pytest.mark.parametrize("reflectance", [0.1, pytest.param(0.5, marks=pytest.mark.slow), 0.9])
@pytest.mark.parametrize(
    ("refinement", "epsilon"), [("brightness-factor", 1e-3 / 6), ("error-radiance", 1e-2), ("error-power", 1e-3 / 6)]
)
def test_furnace(reflectance, refinement, epsilon):
    bound = 0.05 * reflectance / (1 - reflectance)
    assert furnace(reflectance, refinement=refinement, epsilon=epsilon / (1 - reflectance)) < bound


def test_rows_of_links_between_patches_sum_to_one():
    """Where all links are of patches, a receiver's points see all of the cube: what is left is that near pairs take more
    points, 10^-5 of a row, and 1/(1 - rho) times that."""
    assert furnace(0.9, cells=4, refinement="error-radiance", epsilon=1e-6) < 2e-4


def without_push(levels, values):
    return values[levels.leaf_rank]


def without_areas(levels, values):
    """Sums of children in place of means."""
    power = np.zeros((len(levels.area), values.shape[1]))
    power[levels.leaf_rank] = values
    levels.ranks.pull(power)
    return power


@pytest.mark.parametrize(("name", "wrong"), [("push_ranks", without_push), ("pull_ranks", without_areas)])
def test_the_furnace_rejects_wrong_variants(monkeypatch, name, wrong):
    coarse = {"reflectance": 0.5, "cells": 4, "refinement": "error-radiance", "epsilon": 0.05}
    assert furnace(**coarse) < 0.1
    monkeypatch.setattr(Levels, name, wrong)
    assert not furnace(**coarse) < 0.1


def test_three_surfaces():
    """Floor, ceiling and walls of a cube as one patch a face: the equation with Howell's factors."""
    emission, reflectance = np.array([1, 0, 0, 0, 0, 2.0]), np.array([0.2, 0.5, 0.5, 0.5, 0.5, 0.8])
    scene = enclosures.cube(reflectance[:, None], emission[:, None])
    normal = scene.normal @ scene.normal.T
    opposite, beside = enclosures.parallel_squares()[1], enclosures.perpendicular_squares()[1]
    factors = np.where(normal < -0.5, opposite, np.where(normal > 0.5, 0, beside))
    exact = np.linalg.solve(np.eye(6) - reflectance[:, None] * factors, emission)
    found = solved(rd.subdivide(scene, cells=1)).radiosity[:, 0]
    np.testing.assert_allclose(found, exact, rtol=5e-4)  # two in 10^4 of a factor, times 1/(1 - rho)


@pytest.mark.parametrize("refinement", REFINEMENTS)
def test_two_surfaces_one_within_the_other(refinement, geometry_of):
    """A ball in a box: the share of the box's light that lands on the ball is the ratio of areas, the rest lands on the box
    behind it. What lands on the ball meets no obstacle; 20 000 links of 16 rays tell what passes by within 0.3 %."""
    scene, share = enclosures.sphere_in_box()
    scene = replace(scene, emission=np.where(scene.surface[:, None] == 1, 1.0, 0.0))
    patches = rd.subdivide(scene, size=0.25, powers_of_two=True)
    result = solved(patches, geometry_of(patches), refinement=refinement)
    power = np.bincount(patches.surface, patches.area * result.irradiance[:, 0])
    area = np.bincount(patches.surface, patches.area)
    assert power[0] / area[0] == pytest.approx(1, rel=2e-3)
    assert power[1] / area[1] == pytest.approx(1 - share, rel=3e-3)
    assert 0 < result.hidden < result.links
    assert 16 * result.links <= result.rays <= 16 * result.pairs


def exact_irradiance(scene, patches):
    """Of the second of two squares, at the patches' middles."""
    rows = np.flatnonzero(patches.surface == 1)
    corners = np.broadcast_to(scene.vertices[scene.faces[0]], (len(rows), 4, 3))
    return rows, from_points(patches.centroid[rows], patches.normal[rows], corners)


@pytest.mark.parametrize("refinement", REFINEMENTS[1:])
@pytest.mark.parametrize("make", [enclosures.parallel_squares, enclosures.perpendicular_squares])
def test_the_indicated_error_is_no_smaller_than_the_true_one(make, refinement):
    scene, _ = make()
    for cells in (4, 16):
        patches = cut(scene, cells)
        result = solved(patches, refinement=refinement, epsilon=1e-3)
        rows, exact = exact_irradiance(scene, patches)
        assert (np.abs(result.irradiance[rows, 0] - exact) <= result.indicated[rows, 0]).all()


FIRST = {"brightness-factor": 1e-2, "error-radiance": 0.3, "error-power": 1e-2}  # epsilon
FALLS = [(enclosures.parallel_squares, refinement) for refinement in FIRST]
FALLS += [(enclosures.perpendicular_squares, "error-radiance")]
SLOW_FALLS = [(enclosures.perpendicular_squares, refinement) for refinement in ("brightness-factor", "error-power")]


@pytest.mark.parametrize(("make", "refinement"), [*FALLS, *(pytest.param(*case, marks=pytest.mark.slow) for case in SLOW_FALLS)])
def test_errors_fall_with_epsilon(make, refinement):
    scene, value = make()
    patches = cut(scene, 16)
    rows, exact = exact_irradiance(scene, patches)
    errors, links = [], []
    for epsilon in FIRST[refinement] * 10.0 ** -np.arange(4):
        result = solved(patches, refinement=refinement, epsilon=epsilon)
        assert result.irradiance[rows, 0].mean() == pytest.approx(value, rel=1e-3)  # the mean is right with any links
        errors.append(math.sqrt(((result.irradiance[rows, 0] - exact) ** 2).mean()) / value)
        links.append(result.links)
    assert links == sorted(links)
    assert errors[-1] < 0.01
    assert errors[-1] < 0.25 * errors[0]
    assert all(later <= 1.05 * before for before, later in pairwise(errors))


def test_links_grow_with_the_number_of_elements():
    """Squares with a common edge, along which elements are divided without end: four times as many patches, four times as many
    links (a matrix has sixteen times as many), so links of an element are bounded."""
    counts, shares = [], []
    for cells in (8, 16, 32):
        result = solved(cut(enclosures.perpendicular_squares()[0], cells), refinement="error-radiance", epsilon=0.02)
        counts.append(result.links)
        shares.append(result.links / result.elements)
    assert counts[2] < 5 * counts[1]
    assert max(shares) < 30


def test_links_stop_growing_where_every_link_is_weak():
    counts = [solved(cut(enclosures.parallel_squares()[0], cells), epsilon=1e-4).links for cells in (8, 16, 32)]
    assert counts[0] == counts[1] == counts[2]


def test_first_links_are_all_pairs_of_faces():
    result = solved(cut(enclosures.cube(0.5, 0.5)), epsilon=1.0, coarsest=1.0)
    assert (result.links, result.elements, result.pairs) == (30, 6, 30)
    assert [(stage.epsilon, stage.links) for stage in result.history] == [(1.0, 30)]


def test_units_size_and_brightness_do_not_matter():
    scene = rd.load_scene("room")
    larger = replace(scene, vertices=scene.vertices * 8, emission=scene.emission * 4, back_emission=scene.back_emission * 4)
    for refinement in REFINEMENTS:
        one, other = (solved(cut(x, 2), refinement=refinement, epsilon=1e-3) for x in (scene, larger))
        assert one.links == other.links
        np.testing.assert_allclose(other.radiosity, 4 * one.radiosity, rtol=1e-9)


def test_bands_are_solved_together():
    emission = np.zeros((6, 3))
    emission[5] = (1, 2, 0)
    scene = enclosures.cube(np.tile([0.5, 0.5, 0.9], (6, 1)), emission)
    result = solved(cut(scene, 4))
    np.testing.assert_allclose(result.radiosity[:, 1], 2 * result.radiosity[:, 0], rtol=1e-6)
    assert (result.radiosity[:, 2] == 0).all()


def test_the_solution_with_given_links_is_that_of_the_equation():
    patches = cut(enclosures.cube(0.7, 0.3), 4)
    result = solved(patches, epsilon=1e-2)
    again = Exchange(Levels(Hierarchy(patches)), result.final).gather(result.radiosity)
    np.testing.assert_allclose(again, result.irradiance, rtol=1e-7)
    assert np.array_equal(result.radiosity, patches.emission + patches.reflectance * result.irradiance)


def test_too_many_faces_are_refused_with_numbers(monkeypatch):
    patches = cut(rd.load_scene("room"), 1)
    wanted = roots.estimate(Hierarchy(patches))
    sides = len(np.unique(np.stack([patches.face, patches.is_back]), axis=1).T)
    assert wanted.pairs <= sides * (sides - 1)
    for name in ("MOST_PAIRS", "MOST_LINKS"):
        monkeypatch.undo()
        monkeypatch.setattr(roots, name, 10)
        with pytest.raises(rd.MethodError, match=r"pairs of radiating sides, .* GiB .*merge small"):
            solved(patches)


def test_too_many_links_are_refused_with_numbers(monkeypatch):
    monkeypatch.setattr(refining, "MOST_LINKS", 1000)
    with pytest.raises(rd.MethodError, match=r"links at epsilon .*larger epsilon"):
        solved(cut(enclosures.cube()), epsilon=1e-6)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"refinement": "best"}, "refinement 'best' does not exist"),
        ({"epsilon": 0.0}, "epsilon is 0"),
        ({"epsilon": math.nan}, "epsilon is nan"),
        ({"tolerance": 1.0}, "tolerance is 1"),
        ({"rays": -1}, "rays of a link are -1"),
        ({"step": 1.0}, "step 1.0"),
    ],
)
def test_senseless_parameters(values, message):
    with pytest.raises(rd.MethodError, match=message):
        Hierarchical(**values)


def test_elements_count_what_links_ask_for():
    patches = cut(enclosures.parallel_squares()[0], 8)
    result = solved(patches, epsilon=1e-4)
    level = Hierarchy(patches).level(np.concatenate([result.final.receiver, result.final.source]))
    assert result.elements == sum(2 * 4**k for k in range(level.max() + 1))
    assert elements.area(Hierarchy(patches), result.final.receiver).min() > 0
