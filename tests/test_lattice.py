"""Neighbours on lattices: they are found by whole numbers, within faces and across them, and never where something differs."""

import numpy as np
import pytest
from lattices import HIGH, WIDE, wall

import radiosity as rd
from radiosity.solution.lattice import Lattice


def links(patches) -> set:
    """The pairs of neighbours, told by their centroids."""
    after = Lattice.of(patches).after
    place = [tuple(row) for row in np.round(patches.centroid, 9) + 0.0]
    return {frozenset((place[i], place[j])) for way in after for i, j in enumerate(way) if j >= 0}


@pytest.mark.parametrize(("columns", "rows"), [(7, 4), (1, 5), (1, 1)])
def test_cells_of_a_parallelogram_have_those_beside_them(columns, rows):
    patches = rd.subdivide(wall(1, 1), size=10)
    patches = type(patches)(patches.scene, np.int32([columns]), np.int32([rows]))
    lattice = Lattice.of(patches)
    assert sorted((way >= 0).sum() for way in lattice.after) == sorted([0, rows * (columns - 1), columns * (rows - 1)])
    assert len(links(patches)) == rows * (columns - 1) + columns * (rows - 1)
    for way in lattice.after:
        here = np.flatnonzero(way >= 0)
        steps = patches.centroid[way[here]] - patches.centroid[here]
        assert np.allclose(np.sort(np.abs(steps), axis=1)[:, :2], 0, atol=1e-12)
        assert np.allclose(np.abs(steps).max(axis=1), WIDE / columns) or np.allclose(np.abs(steps).max(axis=1), HIGH / rows)
    for back, forth in zip(lattice.before, lattice.after, strict=True):
        here = np.flatnonzero(forth >= 0)
        assert (back[forth[here]] == here).all()
        assert (back >= 0).sum() == len(here)


def test_cells_of_a_triangle_are_two_lattices_of_three_axes():
    k = 6
    patches = rd.subdivide(rd.Scene.from_arrays([[0, 0, 0], [3, 0, 0], [1, 2, 0]], [[0, 1, 2]], 0.5, 1.0), cells=k)
    lattice = Lattice.of(patches)
    _, _, inverted = patches.place
    for way in lattice.after:
        here = np.flatnonzero(way >= 0)
        assert (inverted[way[here]] == inverted[here]).all()
        assert len(here) == k * (k - 1) / 2 + (k - 1) * (k - 2) / 2  # of upright and of inverted ones
        steps = patches.centroid[way[here]] - patches.centroid[here]
        assert np.allclose(steps, steps[0], atol=1e-12)


@pytest.mark.parametrize("turned", [0, 1])
def test_a_wall_of_faces_is_the_lattice_of_its_cells(turned):
    """However each face begins, and whatever it is cut into."""
    whole = links(rd.subdivide(wall(1, 1), cells=12))
    assert len(whole) == 2 * 12 * 11
    for faces in (12, 4, 3):
        assert links(rd.subdivide(wall(faces, faces, turned=turned), cells=12 // faces)) == whole


def test_triangles_of_a_wall_have_those_of_their_own_kind():
    patches = rd.subdivide(wall(6, 5, triangles=True), cells=1)
    assert not patches.scene.is_quad.any()
    assert sorted((way >= 0).sum() for way in Lattice.of(patches).after) == [2 * 5 * 4, 2 * 6 * 4, 2 * 5 * 5]


@pytest.mark.parametrize(
    ("by", "noise"), [((0.123, 0.7, 1.9), 0), ((1000.1, -2000.3, 50.7), 0), ((0, 0, 0), 2e-6), ((90, 20, 3), 5e-6)]
)
def test_neighbours_stay_where_coordinates_are_rounded_or_far_away(by, noise):
    """Rounded corners make no parallelograms, so the wall is of triangles then."""
    scene = wall(16, 16, triangles=noise > 0)
    vertices = scene.vertices + by + noise * np.random.default_rng(1).standard_normal(scene.vertices.shape)
    other = rd.Scene.from_arrays(vertices, scene.faces, 0.5, 1.0)
    expected = [2 * 15 * 15, 2 * 16 * 15, 2 * 16 * 15] if noise else [0, 16 * 15, 16 * 15]
    assert sorted((way >= 0).sum() for way in Lattice.of(rd.subdivide(other, cells=1)).after) == expected


def two_walls(**second) -> rd.Patches:
    """Two unit squares beside each other, cut into 4 x 4 cells; the second is changed."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    other = second.pop("corners", SQUARE)
    faces = second.pop("faces", [[0, 1, 2, 3], [4, 5, 6, 7]])
    return rd.subdivide(rd.Scene.from_arrays(np.concatenate([square, other]), faces, 0.5, 1.0, **second), cells=4)


SQUARE = np.array([[1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0]], float)
APART = {
    "another surface": {"surface": [0, 1], "names": ["a", "b"]},
    "another height": {"corners": SQUARE + np.array([0, 0, 0.01])},
    "upright": {"corners": np.array([[1, 0, 0], [1, 0, 1], [1, 1, 1], [1, 1, 0]], float)},
    "the other side": {"faces": [[0, 1, 2, 3], [7, 6, 5, 4]]},
    "larger cells": {"corners": np.array([[1, 0, 0], [2.2, 0, 0], [2.2, 1, 0], [1, 1, 0]], float)},
    "half a cell aside": {"corners": SQUARE + np.array([0, 0.125, 0])},
    "a gap": {"corners": SQUARE + np.array([0.05, 0, 0])},
    "a cell aside": {"corners": SQUARE + np.array([0.25, 0, 0])},
}


def test_two_squares_of_a_plane_are_one_lattice():
    assert len(links(two_walls())) == 2 * 2 * 4 * 3 + 4


@pytest.mark.parametrize("why", APART)
def test_what_differs_is_no_neighbour(why):
    assert len(links(two_walls(**dict(APART[why])))) == 2 * 2 * 4 * 3


def test_faces_on_each_other_have_no_neighbours():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    patches = rd.subdivide(rd.Scene.from_arrays(square, [[0, 1, 2, 3], [0, 1, 2, 3]], 0.5, 1.0), cells=3)
    assert (Lattice.of(patches).after < 0).all()


def test_the_sides_of_a_face_are_two_lattices():
    patches = rd.subdivide(wall(1, 1, two_sided=True), cells=5)
    lattice = Lattice.of(patches)
    for way in lattice.after:
        here = np.flatnonzero(way >= 0)
        assert (patches.is_back[way[here]] == patches.is_back[here]).all()
    assert (lattice.after >= 0).sum() == 2 * 2 * 5 * 4
    assert len(np.unique(lattice.sheet)) == 2
    assert len(np.unique(lattice.sheet[patches.is_back])) == 1


def test_pairs_are_at_equal_distances_and_as_far_as_the_rim_allows():
    patches = rd.subdivide(wall(1, 1), cells=12)
    middle = patches.centroid
    for step, pairs in zip((1, 2, 4, 8), Lattice.of(patches).pairs(4), strict=True):
        for axis, (size, (back, forth)) in enumerate(zip((WIDE / 12, HIGH / 12), pairs, strict=True)):
            assert np.allclose((middle[back] + middle[forth]) / 2, middle, atol=1e-12)
            steps = np.rint((middle[forth] - middle[back])[:, axis] / 2 / size).astype(int)
            place = np.rint(middle[:, axis] / size - 0.5).astype(int)
            room = np.minimum(place, 11 - place)
            most = np.minimum(2 ** np.floor(np.log2(np.maximum(room, 1))), step) * (room > 0)
            assert (np.abs(steps) == most).all()


def test_pairs_do_not_leap_over_holes():
    """In a wall with a face left out, in the middle of the row of seven."""
    patches = rd.subdivide(wall(7, 1, without=[3]), cells=1)
    steps = [np.abs(forth - back) / 2 for (back, forth) in (pairs[0] for pairs in Lattice.of(patches).pairs(2))]
    assert steps[0].tolist() == [0, 1, 0, 0, 1, 0]
    assert steps[1].tolist() == [0, 1, 0, 0, 1, 0]


@pytest.mark.filterwarnings("ignore:.*without area left out")
@pytest.mark.parametrize("seed", range(3))
def test_thin_and_tiny_cells_are_no_fault(seed):
    """Slivers of any shape at any scale: what is found is symmetric, and nothing is warned of."""
    rng = np.random.default_rng(seed)
    corners = rng.standard_normal((40, 3, 3))
    corners[:, 2] = corners[:, 1] + 10.0 ** rng.uniform(-5, 0, (40, 1)) * rng.standard_normal((40, 3))
    corners *= 10.0 ** rng.uniform(-3, 3, (40, 1, 1))
    patches = rd.subdivide(rd.Scene.from_arrays(corners.reshape(-1, 3), np.arange(120).reshape(-1, 3), 0.5, 1.0), cells=3)
    lattice = Lattice.of(patches)
    for way in lattice.after:
        here = np.flatnonzero(way >= 0)
        assert (patches.face[way[here]] == patches.face[here]).all()
        assert len(np.unique(way[here])) == len(here)
