"""Cells of faces: numbers, places and corners are one another's inverse, and areas add up."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import radiosity as rd
from radiosity.patches import cells
from radiosity.scene.model import Back
from radiosity.scene.paint import Paint

TRIANGLE = rd.Scene.from_arrays([(0, 0, 0), (3, 0, 1), (1, 2, 0)], [(0, 1, 2)], 0.5, 1.0)
PARALLELOGRAM = rd.Scene.from_arrays([(0, 0, 0), (3, 0, 1), (4, 2, 1), (1, 2, 0)], [(0, 1, 2, 3)], 0.5, 1.0)
MIXED = rd.Scene.from_arrays(
    [(0, 0, 0), (3, 0, 1), (4, 2, 1), (1, 2, 0), (0, 0, 9)],
    [(0, 1, 2, 3), (0, 1, 4, -1), (1, 2, 4, -1), (3, 2, 1, 0)],
    [0.1, 0.2, 0.3, 0.4],
    [1, 2, 3, 4],
    two_sided=[False, True, False, True],
    back_reflectance=[0.5, 0.6, 0.7, 0.8],
    back_emission=[5, 6, 7, 8],
    surface=[0, 1, 1, 2],
    names=["a", "b", "c"],
)


def all_cells(columns: int, rows: int, quad: bool):
    """Every cell's number, its grid and its place."""
    n = columns * rows
    number, c, r, q = np.arange(n), np.full(n, columns), np.full(n, rows), np.full(n, quad)
    return number, c, r, q, cells.place(number, c, q)


shapes = st.one_of(
    st.tuples(st.integers(1, 40), st.integers(1, 40), st.just(True)),
    st.integers(1, 40).map(lambda k: (k, k, False)),
)


@settings(max_examples=60)
@given(shapes, st.integers(0, 2**32 - 1))
def test_number_place_and_corners_are_inverse(shape, seed):
    number, c, r, q, place = all_cells(*shape)
    corners = cells.corners(*place, c, r, q)
    weights = np.random.Generator(np.random.Philox(seed)).dirichlet(np.ones(4), len(number))
    u, v = np.einsum("ij,ijk->ki", weights, corners)  # a point inside each cell
    assert (cells.number(u, v, c, r, q) == number).all()
    assert (cells.count(c, r) == len(number)).all()


@settings(max_examples=60)
@given(shapes)
def test_cells_are_congruent_and_tile_the_face(shape):
    columns, rows, quad = shape
    *_, c, r, q, place = all_cells(*shape)
    x, y = np.moveaxis(cells.corners(*place, c, r, q), 2, 0)
    area = 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)  # positive: counterclockwise
    np.testing.assert_allclose(area, (1 if quad else 0.5) / (columns * rows), rtol=1e-9)
    # equal areas that sum to the face's, no two cells with one place, all within the face: they tile it
    assert len(np.unique(np.stack(place), axis=1).T) == columns * rows
    assert min(x.min(), y.min()) >= 0
    assert max(x.max(), y.max()) <= 1 + 1e-12
    assert quad or (x + y).max() <= 1 + 1e-12


@pytest.mark.parametrize("k", [cells.MOST, 12345])
@pytest.mark.parametrize("quad", [True, False])
def test_large_grids_are_exact(k, quad, random):
    number = np.unique(np.concatenate([[0, k * k - 1, k * k - 2, 2 * k - 1, 2 * k - 2], random.integers(0, k * k, 5000)]))
    c, q = np.full(len(number), k), np.full(len(number), quad)
    column, row, inverted = cells.place(number, c, q)
    middle = np.where(q, 0.5, np.where(inverted, 2 / 3, 1 / 3))
    assert (cells.number((column + middle) / k, (row + middle) / k, c, c, q) == number).all()


@pytest.mark.parametrize("quad", [True, False])
def test_points_over_the_rim_belong_to_a_cell_beside_it(quad):
    u, v = np.array([-1e-7, 1 + 1e-7, -1e-7, 1 + 1e-7, 0.5, 0.50001]), np.array([-1e-7, -1e-7, 1 + 1e-7, 1 + 1e-7, 0.5, 0.5])
    seven = np.full(len(u), 7)
    found = cells.number(u, v, seven, seven, np.full(len(u), quad))
    assert ((found >= 0) & (found < 49)).all()
    assert found[0] == 0
    assert found[1] == (6 if quad else 12)
    assert found[2] == (42 if quad else 48)


@pytest.mark.parametrize(
    "scene",
    [TRIANGLE, PARALLELOGRAM, MIXED, *map(rd.load_scene, ("room", "cornell-box"))],
    ids=["triangle", "parallelogram", "mixed", "room", "cornell-box"],
)
@pytest.mark.parametrize("cut", [{"cells": 1}, {"cells": 7}, {"size": 0.31}], ids=str)
def test_patches_cover_their_faces(scene, cut):
    patches = rd.subdivide(scene, **cut)
    sides = np.where(scene.back == Back.RADIATES, 2, 1)
    assert len(patches) == patches.first[-1] == len(patches.face) == len(patches.corners)
    np.testing.assert_allclose(np.bincount(patches.face, patches.area, scene.n_faces), scene.area * sides, rtol=1e-12)
    a, b, c, d = np.moveaxis(patches.corners, 1, 0)
    cross = np.cross(c - a, d - b) / 2  # vector area of a quadrilateral, also where two corners are one
    np.testing.assert_allclose(cross, patches.area[:, None] * patches.normal, atol=1e-12 * scene.area.max())
    distinct = np.where(scene.is_quad[patches.face], 4, 3)[:, None]
    twice = np.where(distinct == 3, d, 0)  # a triangle's repeated corner, its last from either side
    assert np.array_equal((c == d).all(axis=1), distinct[:, 0] == 3)
    np.testing.assert_allclose(patches.centroid, (a + b + c + d - twice) / distinct, atol=1e-12 * np.abs(scene.bounds).max())


def test_sides_and_order():
    patches = rd.subdivide(MIXED, cells=2)
    assert patches.face.tolist() == [0] * 4 + [1] * 8 + [2] * 4 + [3] * 8
    assert patches.is_back.tolist() == [False] * 4 + ([False] * 4 + [True] * 4) + [False] * 4 + ([False] * 4 + [True] * 4)
    assert patches.surface.tolist() == [0] * 4 + [1] * 12 + [2] * 8
    np.testing.assert_allclose(patches.normal[4:8], -patches.normal[8:12])
    np.testing.assert_allclose(patches.centroid[4:8], patches.centroid[8:12])
    assert patches.reflectance[:, 0].tolist() == [0.1] * 4 + [0.2] * 4 + [0.6] * 4 + [0.3] * 4 + [0.4] * 4 + [0.8] * 4
    assert patches.emission[:, 0].tolist() == [1] * 4 + [2] * 4 + [6] * 4 + [3] * 4 + [4] * 4 + [8] * 4


def test_size_bounds_edges_and_areas():
    patches = rd.subdivide(PARALLELOGRAM, size=0.5)
    _, first, second = PARALLELOGRAM.frames
    assert patches.columns[0] == np.ceil(np.linalg.norm(first) / 0.5)
    assert patches.rows[0] == np.ceil(np.linalg.norm(second) / 0.5)
    patches = rd.subdivide(TRIANGLE, size=0.5)
    assert patches.area.max() <= 0.5**2 / 2
    assert (patches.columns == patches.rows).all()
    coarser = patches.area[0] * patches.columns[0] ** 2 / (patches.columns[0] - 1) ** 2
    assert coarser > 0.5**2 / 2


def test_a_size_that_divides_an_edge_is_met_exactly():
    square = rd.Scene.from_arrays([(0, 0, 0), (0.3, 0, 0), (0.3, 0.7, 0), (0, 0.7, 0)], [(0, 1, 2, 3)], 0.5, 1.0)
    patches = rd.subdivide(square, size=0.1)
    assert (patches.columns[0], patches.rows[0]) == (3, 7)
    over = [(n, size) for n in range(1, 60) for size in (0.1, 0.07, 0.3, 1e-3, 1 / 3) if (n * size + 5.0 - 5.0) / size > n]
    assert len(over) > 20  # quotients that rounding leaves above the whole number
    for n, size in over:
        edge = n * size + 5.0  # as far from zero as rooms are
        scene = rd.Scene.from_arrays([(5, 5, 0), (edge, 5, 0), (edge, edge, 0), (5, edge, 0)], [(0, 1, 2, 3)], 0.5, 1.0)
        patches = rd.subdivide(scene, size=size)
        assert (patches.columns[0], patches.rows[0]) == (n, n)


@pytest.mark.parametrize("cells", [1, 2, 5])
@pytest.mark.parametrize("scene", [TRIANGLE, PARALLELOGRAM], ids=["triangle", "parallelogram"])
def test_the_mean_of_a_linear_paint_is_its_value_in_the_middle(scene, cells):
    """Exactly, in upright and inverted cells, on either side; of an image that is linear likewise."""
    slope, base = np.array([0.05, 0.03, 0.02]), 0.2
    colour = (base + scene.vertices[np.where(scene.faces >= 0, scene.faces, 0)] @ slope)[..., None].astype(np.float32)
    none = np.full(1, -1, np.int32)
    paint = Paint((), none, np.zeros((1, 4, 2), np.float32), colour)
    sides = replace(scene, back=np.array([Back.RADIATES], np.uint8), reflectance_paint=paint, emission_paint=paint)
    patches = rd.subdivide(sides, cells=cells)
    expected = base + patches.centroid @ slope
    np.testing.assert_allclose(patches.reflectance[:, 0], 0.5 * expected, rtol=1e-6)
    np.testing.assert_allclose(patches.emission[:, 0], expected, rtol=1e-6)


def test_the_hash_tells_cuts_apart():
    ones = np.ones(1, np.int32)
    cuts = [rd.Patches(PARALLELOGRAM, a * ones, b * ones) for a, b in ((1, 1), (1, 2), (2, 1), (2, 2), (1, 4))]
    assert len({cut.hash for cut in cuts}) == len(cuts)
    assert rd.Patches(PARALLELOGRAM, 2 * ones, ones).hash == cuts[2].hash


@pytest.mark.parametrize("name", ["room", "cornell-box", "labyrinth"])
def test_default_is_about_20_000(name):
    assert 15_000 <= len(rd.subdivide(rd.load_scene(name))) <= 20_000


def test_default_with_huge_walls_and_tiny_details(random):
    tiny = [(0, 0, 0), (1e-3, 0, 0), (0, 1e-3, 0)]
    places = random.uniform(1, 99, (3000, 1, 3))
    details = (places + tiny).reshape(-1, 3)
    wall = [(0, 0, 0), (100, 0, 0), (100, 100, 0), (0, 100, 0)]
    faces = [*(np.arange(9000).reshape(-1, 3).tolist()), [9000, 9001, 9002], [9000, 9002, 9003]]
    scene = rd.Scene.from_arrays([*details.tolist(), *wall], faces, 0.5, 1.0)
    patches = rd.subdivide(scene)
    assert (patches.cells_per_face[:3000] == 1).all()
    assert 15_000 <= len(patches) - 3000 <= 20_000


def test_default_is_one_a_face_where_there_are_many():
    n = 25_000
    corners = np.tile([(0, 0, 0), (1, 0, 0), (0, 1, 0)], (n, 1)) + np.repeat(np.arange(n), 3)[:, None]
    scene = rd.Scene.from_arrays(corners, np.arange(3 * n).reshape(-1, 3), 0.5, 1.0)
    assert len(rd.subdivide(scene)) == n


def test_default_cuts_a_wall_however_many_details_there_are():
    n = 25_000
    corners = (np.tile([(0, 0, 0), (1, 0, 0), (0, 1, 0)], (n, 1)) + np.repeat(np.arange(n), 3)[:, None]).tolist()
    wall = [(0, 0, -50), (200, 0, -50), (200, 200, -50), (0, 200, -50)]
    faces = [*([3 * i, 3 * i + 1, 3 * i + 2, -1] for i in range(n)), [3 * n, 3 * n + 1, 3 * n + 2, 3 * n + 3]]
    patches = rd.subdivide(rd.Scene.from_arrays([*corners, *wall], faces, 0.5, 1.0))
    assert (patches.cells_per_face[:-1] == 1).all()
    assert 15_000 <= patches.cells_per_face[-1] <= 20_000


def test_surfaces_keep_their_own_size():
    scene = replace(rd.load_scene("room"), patch_size=np.array([np.nan] * 4 + [0.5] + [np.nan] * 4))
    floor = scene.surface == scene.names.index("floor")
    patches = rd.subdivide(scene, size=1.0)
    assert sorted((int(patches.columns[floor][0]), int(patches.rows[floor][0]))) == [8, 12]
    ceiling = scene.surface == scene.names.index("ceiling")
    assert sorted((int(patches.columns[ceiling][0]), int(patches.rows[ceiling][0]))) == [4, 6]
    assert (rd.subdivide(scene, cells=3).columns == 3).all()


@pytest.mark.parametrize(
    ("cut", "message"),
    [
        ({"size": 0.1, "cells": 2}, "not both"),
        ({"cells": 0}, "cells is 0"),
        ({"cells": -3}, "cells is -3"),
        ({"cells": 1.5}, "cells is 1.5"),
        ({"cells": True}, "cells is True"),
        ({"cells": np.nan}, "cells is nan"),
        ({"cells": np.inf}, "cells is inf"),
        ({"cells": "many"}, "cells is 'many'"),
        ({"cells": 2**40}, "cells along an edge"),
        ({"size": 0}, "patch size is 0"),
        ({"size": -1.0}, "patch size is -1"),
        ({"size": np.nan}, "patch size is nan"),
        ({"size": np.inf}, "patch size is inf"),
        ({"size": "small"}, "patch size is 'small'"),
        ({"size": 1e-9}, "face 0 of surface 'surface' would have .* take larger patches"),
    ],
)
def test_senseless_cuts(cut, message):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(rd.SceneError, match=message):
            rd.subdivide(PARALLELOGRAM, **cut)


def test_more_patches_than_can_be_counted():
    with pytest.raises(rd.SceneError, match="patches, more than"):
        rd.subdivide(rd.load_scene("room"), cells=cells.MOST)
