"""Smooth display across triangles and hanging nodes: no streaks, no steps, and nothing across contact lines, planes and sides."""

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.image import display_mesh
from radiosity.image.lookup import Lookup
from radiosity.image.plane_fit import PlaneFit, at_vertices
from radiosity.scene.cut import Cut
from radiosity.scene.shapes import join, quad
from radiosity.tracing.first_hits import Hits


def fan(n=24):
    """A square of 2 m as a fan of long triangles from one corner."""
    rim = np.array([[2, t, 0] for t in np.linspace(0, 2, n // 2 + 1)] + [[t, 2, 0] for t in np.linspace(2, 0, n // 2 + 1)[1:]])
    faces = [[0, k, k + 1] for k in range(1, n + 1)]
    return rd.Scene.from_arrays(np.concatenate([[[0, 0, 0]], rim]), faces, reflectance=0.5, emission=0.0, names=["wall"])


def shown(look, face, u, v, front=True):
    """What a lookup shows at face coordinates."""
    u, v = np.broadcast_arrays(np.asarray(u, float), np.asarray(v, float))
    n = len(u)
    return look(Hits(np.broadcast_to(face, n), u, v, np.full(n, front), np.ones(n)))[0][:, 0]


def inside(n, seed=1):
    """Coordinates inside of a triangle."""
    u, v = np.random.default_rng(seed).random((2, n))
    return np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)


def test_a_fan_of_triangles_has_no_streaks():
    """An even slope, and a tenth of noise from triangle to triangle: what is left of the noise is half of what vertices leave."""
    scene = fan()
    patches = rd.subdivide(scene, cells=4)
    slope = patches.centroid @ [1.0, 0.5, 0.0]
    noisy = slope + 0.1 * np.where(patches.face % 2, 1, -1)
    u, v = inside(1500)
    face = np.random.default_rng(2).integers(0, scene.n_faces, 1500)
    origin, first, second = (edge[face] for edge in scene.frames)
    true = (origin + u[:, None] * first + v[:, None] * second) @ [1.0, 0.5, 0.0]
    look = Lookup(patches, noisy[:, None])
    fitted = shown(look, face, u, v) - true
    vars(look)["planes"] = type("None", (), {"fits": lambda self, patch: np.zeros(len(patch), bool), "at": look.planes.at})()
    corners = shown(look, face, u, v) - true
    assert np.sqrt(np.mean(fitted**2)) < 0.5 * np.sqrt(np.mean(corners**2))
    even = shown(Lookup(patches, slope[:, None]), face, u, v) - true
    assert np.abs(even).max() < 0.25  # at most the half of a patch, at the rim, where values are not extrapolated
    assert np.sqrt(np.mean(even**2)) < 0.04  # of 3


def hanging(regions=(0, 0, 0)):
    """A floor of a large square of 2 x 2 cells, and beside it two small ones of 4 x 4: their cells are half as large."""
    small = [quad((1, y, 0), (0.5, 0, 0), (0, 0.5, 0)) for y in (0, 0.5)]
    parts = [quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), *small]
    scene = join([("floor", 0.5, 0.0, parts)], source="hanging")
    scene = replace(scene, cut=Cut(scene.hash, np.arange(3), np.array(regions)))
    return rd.Patches(scene, np.array([2, 4, 4]), np.array([2, 4, 4]))


def test_hanging_nodes_make_no_steps():
    """Light of a slope, seen along a line over the seam: it rises evenly, where values of vertices have a step."""
    patches = hanging()
    values = (patches.centroid @ [1.0, 0.0, 0.0])[:, None]
    look = Lookup(patches, values)
    assert look.planes.fits(np.arange(len(patches))).all()
    left = shown(look, 0, np.linspace(0.6, 1, 100), np.full(100, 0.3))
    right = shown(look, 1, np.linspace(0, 0.6, 100), np.full(100, 0.6))
    line = np.concatenate([left, right])
    assert np.abs(np.diff(line)).max() < 0.02
    assert abs(left[-1] - right[0]) < 1e-6
    assert line[-1] - line[0] == pytest.approx(0.7, rel=0.1)


def test_contact_lines_break_it():
    patches = hanging((0, 1, 1))
    values = (patches.face > 0).astype(float)[:, None]
    look = Lookup(patches, values)
    assert shown(look, 0, [0.99], [0.3])[0] == 0
    assert shown(look, 1, [0.01], [0.3])[0] == 1


def test_planes_and_sides_do_not_mix():
    """Two fans of one surface, one above the other, and their backs: four values, each everywhere."""
    low = fan(8)
    vertices = np.concatenate([low.vertices, low.vertices + np.array([0, 0, 0.01])])
    faces = np.concatenate([low.faces[:, :3], low.faces[:, :3] + len(low.vertices)])
    scene = rd.Scene.from_arrays(vertices, faces, reflectance=0.5, emission=0.0, names=["wall"], two_sided=True)
    patches = rd.subdivide(scene, cells=2)
    values = (2.0 * (patches.face >= 8) + patches.is_back)[:, None]
    look = Lookup(patches, values)
    u, v = inside(40)
    for face, front, expected in ((1, True, 0), (1, False, 1), (9, True, 2), (9, False, 3)):
        assert (shown(look, face, u, v, front) == expected).all()


def test_unknown_patches_are_left_out():
    patches = rd.subdivide(fan(), cells=4)
    values = np.ones((len(patches), 1))
    values[::5] = np.nan
    u, v = inside(200)
    np.testing.assert_allclose(shown(Lookup(patches, values), np.arange(200) % 24, u, v), 1.0, rtol=1e-12)


def test_even_planes_are_smoothed_by_vertices():
    """Parallelograms of cells of one size, and curved surfaces: as they were, to the bit."""
    for scene in (rd.load_scene("room"), rd.load_scene("studio")):
        patches = rd.subdivide(scene, cells=2)
        fit = PlaneFit(patches)
        whole = [name for name in scene.names if scene.is_quad[scene.surface == scene.names.index(name)].all()]
        assert whole
        assert (fit.plane[np.isin(patches.surface, [scene.names.index(name) for name in whole])] == -1).all()


def test_meshes_have_the_fit_at_their_vertices():
    patches = rd.subdivide(fan(), cells=4)
    mesh = display_mesh.build(patches)
    slope = patches.centroid @ [1.0, 0.5, 0.0]
    noisy = (slope + 0.1 * np.where(patches.face % 2, 1, -1))[:, None]
    true = mesh.vertices @ [1.0, 0.5, 0.0]
    inner = ((mesh.vertices[:, :2] > 0.3) & (mesh.vertices[:, :2] < 1.7)).all(axis=1)
    errors = [np.abs(one[inner, 0] - true[inner]).max() for one in (at_vertices(patches, mesh, noisy), mesh.smoothed(noisy))]
    assert errors[0] < 0.08
