"""The display mesh: which vertices are shared, and what smoothing does to values."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from image_samples import quad_scene

import radiosity as rd
from radiosity.image.display_mesh import build
from radiosity.image.weld import weld


def two_squares(names=("one",), surface=(0, 0), angle=0.0, **more):
    """Unit squares that share an edge, the second one folded up by an angle in degrees."""
    c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
    left = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    right = [[1, 0, 0], [1 + c, 0, s], [1 + c, 1, s], [1, 1, 0]]
    return rd.Scene.from_arrays(left + right, [[0, 1, 2, 3], [4, 5, 6, 7]], 0.5, 0.0, surface=surface, names=names, **more)


def test_a_grid_of_two_by_two_shares_its_inner_points():
    mesh = build(rd.subdivide(quad_scene(), cells=2))
    assert mesh.vertices.shape == (9, 3)
    assert sorted(np.bincount(mesh.polygons.ravel())) == [1, 1, 1, 1, 2, 2, 2, 2, 4]


@pytest.mark.parametrize(("angle", "count"), [(0, 15), (29, 15), (31, 18), (90, 18), (180, 18)])
def test_an_edge_is_shared_unless_it_is_a_crease(angle, count):
    assert len(build(rd.subdivide(two_squares(angle=angle), cells=2)).vertices) == count


@pytest.mark.parametrize("two_sided", [False, True])
def test_surfaces_share_no_vertices(two_sided):
    """Nor do the back of one and the front of the next."""
    scene = two_squares(("one", "two"), (0, 1), two_sided=two_sided)
    assert len(build(rd.subdivide(scene, cells=2)).vertices) == 18 * (1 + two_sided)


def test_sides_share_no_vertices():
    assert len(build(rd.subdivide(quad_scene(two_sided=True), cells=2)).vertices) == 18


def test_float32_coordinates_that_differ_in_the_last_digit_are_one_vertex():
    scene = two_squares()
    vertices = scene.vertices + np.array([100.0, 200.0, 50.0])
    vertices[4:] = vertices[4:] + 1e-6
    near = rd.Scene.from_arrays(vertices, [[0, 1, 2, 3], [4, 5, 6, 7]], 0.5, 0.0)
    assert len(build(rd.subdivide(near, cells=4)).vertices) == 45


@pytest.mark.parametrize("cells", [1, 2, 3, 7])
@pytest.mark.parametrize("two_sided", [False, True])
def test_a_sphere_of_triangles_is_closed(cells, two_sided):
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(2)
    scene = rd.Scene.from_arrays(ball.vertices, ball.faces, 0.5, 0.0, two_sided=two_sided)
    mesh = build(rd.subdivide(scene, cells=cells))
    sides = 1 + two_sided
    assert len(mesh.polygons) == 320 * cells**2 * sides
    assert len(mesh.vertices) == (160 * cells**2 + 2) * sides  # Euler: V = F / 2 + 2
    triangles, patch = mesh.triangles()
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    assert patch.tolist() == list(range(len(mesh.polygons)))


@pytest.mark.parametrize("name", ["room", "cornell-box", "labyrinth"])
def test_polygons_are_the_patches(name):
    patches = rd.subdivide(rd.load_scene(name), cells=3)
    for mesh in (build(patches), build(patches).flat()[0]):
        np.testing.assert_allclose(mesh.vertices[mesh.polygons], patches.corners, atol=1e-12)
        np.testing.assert_allclose(mesh.angle.sum(axis=1), np.where(mesh.is_quad, 2 * np.pi, np.pi), rtol=1e-6)
        corners = mesh.vertices[mesh.triangles()[0]]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.bincount(mesh.triangles()[1], np.linalg.norm(cross, axis=1) / 2)
        np.testing.assert_allclose(area, patches.area, rtol=1e-9)
        np.testing.assert_allclose(
            (cross * patches.normal[mesh.triangles()[1]]).sum(axis=1), np.linalg.norm(cross, axis=1), rtol=1e-9
        )


def test_backs_run_the_other_way():
    patches = rd.subdivide(rd.Scene.from_arrays(np.eye(3), [[0, 1, 2]], 0.5, 0.0, two_sided=True), cells=3)
    mesh = build(patches)
    a, b, c = (mesh.vertices[mesh.polygons[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    np.testing.assert_allclose(cross / np.linalg.norm(cross, axis=1, keepdims=True), patches.normal, atol=1e-12)
    np.testing.assert_allclose((a + b + c) / 3, patches.centroid, atol=1e-12)


def test_flat_meshes_share_nothing():
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    mesh, owner = build(patches).flat()
    assert len(mesh.vertices) == (3 + mesh.is_quad).sum()
    assert (owner[mesh.polygons] == np.arange(len(patches))[:, None]).all()


def test_a_constant_stays_constant():
    mesh = build(rd.subdivide(rd.load_scene("cornell-box"), cells=3))
    np.testing.assert_allclose(mesh.smoothed(np.full((len(mesh.polygons), 3), 0.7)), 0.7, rtol=1e-6)


def test_a_linear_field_is_met_inside_and_kept_in_bounds_at_the_rim():
    patches = rd.subdivide(quad_scene(), cells=8)
    mesh = build(patches)
    field = patches.centroid @ [1.0, 2.0, 0.0]
    smooth = mesh.smoothed(field[:, None])[:, 0]
    inside = ((mesh.vertices > 0.01) & (mesh.vertices < 1.99))[:, :2].all(axis=1)
    np.testing.assert_allclose(smooth[inside], mesh.vertices[inside] @ [1.0, 2.0, 0.0], rtol=1e-6)
    assert inside.sum() == 49
    assert smooth.min() >= field.min() - 1e-12
    assert smooth.max() <= field.max() + 1e-12


def test_unknown_patches_are_left_out_of_the_mean():
    mesh = build(rd.subdivide(quad_scene(), cells=2))
    smooth = mesh.smoothed(np.array([[1.0], [np.nan], [3.0], [5.0]]))[:, 0]
    middle = np.flatnonzero(np.bincount(mesh.polygons.ravel()) == 4)[0]
    corner = np.setdiff1d(mesh.polygons[1], mesh.polygons[[0, 2, 3]])[0]
    assert smooth[middle] == pytest.approx(3.0)
    assert np.isnan(smooth[corner])
    assert np.isfinite(np.delete(smooth, corner)).all()


@settings(max_examples=40)
@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 2), st.integers(0, 1), st.integers(0, 23)), max_size=30))
def test_welding_agrees_with_comparing_every_pair(rows):
    rows = np.array(rows, np.int64).reshape(-1, 4)
    angle = np.deg2rad(15.0 * rows[:, 3] + 0.01 * rows[:, 3])
    normal = np.stack([np.cos(angle), np.sin(angle), np.zeros(len(rows))], axis=1)
    points = np.column_stack([rows[:, 0] / 3, rows[:, 1] / 7, np.zeros(len(rows))])
    label = np.arange(len(rows))
    same = (rows[:, None, :3] == rows[None, :, :3]).all(axis=2) & (normal @ normal.T >= np.cos(np.deg2rad(30.0)))
    for _ in rows:
        label = np.array([label[same[i]].min() for i in range(len(rows))], np.int64)
    result = weld(points, rows[:, 2], normal, np.full(len(rows), 1e-6))
    np.testing.assert_array_equal(result[:, None] == result, label[:, None] == label)
