"""Elements of a hierarchy: the arithmetic of numbers, places, parents and children, and that leaves are patches."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import radiosity as rd
from radiosity.patches import Hierarchy, cells, elements

VERTICES = [(0, 0, 0), (3, 0, 1), (4, 2, 1), (1, 2, 0), (0, 0, 9)]
SCENE = rd.Scene.from_arrays(
    VERTICES, [(0, 1, 2, 3), (0, 1, 4, -1), (1, 2, 4, -1), (3, 2, 1, 0)], 0.5, 1.0, two_sided=[False, True, False, True]
)

power = st.integers(0, 5).map(lambda k: 2**k)
cuts = st.tuples(*[power] * 6)


def hierarchy(cut=(4, 8, 2, 4, 16, 2)) -> Hierarchy:
    """Parallelograms of cut[0] x cut[1] and cut[4] x cut[5] cells, triangles with cut[2] and cut[3] along an edge."""
    columns, rows = np.array([cut[0], cut[2], cut[3], cut[4]], np.int32), np.array([cut[1], cut[2], cut[3], cut[5]], np.int32)
    return Hierarchy(rd.patches.Patches(SCENE, columns, rows))


@settings(max_examples=40)
@given(cuts)
def test_numbers_and_places_are_inverse(cut):
    tree = hierarchy(cut)
    every = np.arange(len(tree))
    side, level, *place = tree.place(every)
    assert (tree.at(side, level, *place) == every).all()
    assert (tree.level(every) == level).all()
    assert ((level >= 0) & (level <= tree.deepest[side])).all()
    columns, rows = tree.grid(side, level)
    cell = cells.at(*place, columns, elements.is_quad(tree, every))
    assert ((cell >= 0) & (cell < columns * rows)).all()


@settings(max_examples=40)
@given(cuts)
def test_leaves_are_the_patches(cut):
    tree = hierarchy(cut)
    every = np.arange(len(tree))
    leaves = every[tree.is_leaf(every)]
    patches = tree.patches
    assert np.array_equal(np.sort(tree.patch(leaves)), np.arange(len(patches)))
    leaves = tree.leaf(np.arange(len(patches)))
    assert np.array_equal(tree.patch(leaves), np.arange(len(patches)))
    assert np.array_equal(tree.face(leaves), patches.face)
    np.testing.assert_allclose(elements.area(tree, leaves), patches.area, rtol=1e-12)
    np.testing.assert_allclose(elements.normal(tree, leaves), patches.normal, atol=1e-12)
    np.testing.assert_allclose(elements.centroid(tree, leaves), patches.centroid, atol=1e-12)
    np.testing.assert_allclose(elements.corners(tree, leaves), patches.corners, atol=1e-12)


@settings(max_examples=40)
@given(cuts)
def test_children_and_parents(cut):
    tree = hierarchy(cut)
    every = np.arange(len(tree))
    children = tree.children(every)
    exists = children >= 0
    assert np.array_equal(exists.any(axis=1), ~tree.is_leaf(every))
    assert set(exists.sum(axis=1)) <= {0, 2, 4}
    born = np.sort(children[exists])
    assert np.array_equal(born, np.setdiff1d(every, tree.first[:-1]))  # each once, but the roots
    assert (tree.parent(children[exists]) == np.repeat(every, exists.sum(axis=1))).all()
    assert (tree.parent(tree.first[:-1]) == -1).all()
    inner = exists.any(axis=1)
    area = np.where(exists, elements.area(tree, np.maximum(children, 0).ravel()).reshape(-1, 4), 0)
    np.testing.assert_allclose(area.sum(axis=1)[inner], elements.area(tree, every)[inner], rtol=1e-12)
    moment = (elements.centroid(tree, np.maximum(children, 0).ravel()).reshape(-1, 4, 3) * area[:, :, None]).sum(axis=1)
    np.testing.assert_allclose(moment[inner] / area.sum(axis=1)[inner, None], elements.centroid(tree, every)[inner], atol=1e-12)


@settings(max_examples=40)
@given(cuts, st.integers(0, 2**32 - 1))
def test_elements_are_found_from_face_coordinates(cut, seed):
    """At the deepest level the element is the patch that `cells.number` gives; each level's is the parent of the next one's."""
    tree = hierarchy(cut)
    random = np.random.Generator(np.random.Philox(seed))
    side = random.integers(0, len(tree.side_face), 200)
    u, v = random.uniform(size=(2, 200))
    quad = SCENE.is_quad[tree.side_face[side]]
    over = ~quad & (u + v > 1)
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    found = tree.find(side, np.full(200, 99), u, v)
    face = tree.side_face[side]
    cell = cells.number(u, v, tree.patches.columns[face], tree.patches.rows[face], quad)
    assert np.array_equal(tree.patch(found), tree.side_patch[side] + cell)
    for level in range(6, -1, -1):
        deeper = tree.level(found) > level
        found = np.where(deeper, tree.parent(found), found)
        assert np.array_equal(tree.find(side, np.full(200, level), u, v), found)


def test_corners_turn_about_the_normal_and_bound_the_element():
    tree = hierarchy()
    every = np.arange(len(tree))
    corners = elements.corners(tree, every)
    a, b, c, d = np.moveaxis(corners, 1, 0)
    cross = np.cross(c - a, d - b) / 2
    np.testing.assert_allclose(cross, elements.area(tree, every)[:, None] * elements.normal(tree, every), atol=1e-12)
    assert np.array_equal((c == d).all(axis=1), ~elements.is_quad(tree, every))
    square, half = np.array([[0, 0], [1, 0], [0, 1.0]]), np.array([[0, 0], [1, 0], [0, 1.0]])
    points = elements.points(tree, every, square, half)
    apart = np.linalg.norm(points[:, :, None] - corners[:, None], axis=3).min(axis=2)
    np.testing.assert_allclose(apart, 0, atol=1e-12)  # each point is a corner


@pytest.mark.parametrize("quad", [True, False])
def test_large_hierarchies_are_exact(quad, random):
    scene = rd.Scene.from_arrays(VERTICES[:4], [(0, 1, 2, 3) if quad else (0, 1, 2, -1)], 0.5, 1.0)
    rows = 2 if quad else 8192
    tree = Hierarchy(rd.patches.Patches(scene, np.array([8192], np.int32), np.array([rows], np.int32)))
    assert len(tree) == (1 + 4 * (2**13 - 1) if quad else (4**14 - 1) // 3)
    edges = [tree.first[0], len(tree) - 1]
    some = np.unique(np.concatenate([edges, random.integers(0, len(tree), 5000)]))
    side, level, *place = tree.place(some)
    assert (tree.at(side, level, *place) == some).all()
    children = tree.children(some)
    assert (tree.parent(children[children >= 0]) == np.repeat(some, (children >= 0).sum(axis=1))).all()


def test_other_numbers_of_cells_are_refused():
    with pytest.raises(rd.SceneError, match=r"face 0 of surface 'surface' has 3 x 3 cells.*powers_of_two=True"):
        Hierarchy(rd.subdivide(SCENE, cells=3))


@pytest.mark.parametrize("cut", [{"cells": 5}, {"size": 0.3}, {}], ids=str)
@pytest.mark.parametrize("name", ["room", "cornell-box"])
def test_powers_of_two(name, cut):
    scene = rd.load_scene(name)
    plain, patches = rd.subdivide(scene, **cut), rd.subdivide(scene, powers_of_two=True, **cut)
    assert len(Hierarchy(patches)) > len(patches)
    for count, before in ((patches.columns, plain.columns), (patches.rows, plain.rows)):
        assert (np.log2(count) % 1 == 0).all()
        if cut:  # up to the next power, and no further
            assert (count >= before).all()
            assert (count < 2 * before).all()
    assert cut or 5_000 <= len(patches) <= 20_000
