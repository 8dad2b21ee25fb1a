"""The built-in scenes: closed, looking the right way, and with the numbers that their docstrings promise."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.scene.builtin import CEILING_LIGHT, SCENES, labyrinth
from radiosity.scene.model import Back
from radiosity.scene.topology import open_edges


def enclosed_volume(scene):
    """Volume by the divergence theorem; negative where normals point into it. Any surface that is closed."""
    _, first, second = scene.frames
    centroid = scene.vertices[scene.faces[:, 0]] + (first + second) / np.where(scene.is_quad, 2, 3)[:, None]
    return float((np.einsum("ij,ij->i", centroid, scene.normal) * scene.area).sum() / 3)


def only(scene, *names):
    return scene.take(np.isin(scene.surface, [scene.names.index(name) for name in names]))


WALLS = ("south wall", "north wall", "west wall", "east wall", "floor", "ceiling")


def test_room_measures():
    scene = rd.load_scene("room")
    walls = only(scene, *WALLS)
    assert scene.n_faces == 17
    assert scene.is_quad.all()
    assert len(open_edges(walls).face) == 0
    assert enclosed_volume(walls) == pytest.approx(-6 * 4 * 3, rel=1e-12)
    assert walls.area.sum() == pytest.approx(2 * (6 * 4 + 6 * 3 + 4 * 3), rel=1e-12)


@pytest.mark.parametrize(("name", "volume"), [("low box", 1.2 * 1.2 * 0.8), ("tall box", 1.0 * 1.0 * 1.8)])
def test_room_boxes_stand_on_the_floor_and_look_outwards(name, volume):
    scene = only(rd.load_scene("room"), name)
    assert len(open_edges(scene).face) == 4  # the bottom rim
    assert scene.bounds[0, 2] == 0  # so the missing bottom adds nothing to the volume
    assert enclosed_volume(scene) == pytest.approx(volume, rel=1e-12)


def test_room_light_shines_down():
    scene = rd.load_scene("room")
    light = only(scene, "light")
    assert light.normal.tolist() == [[0, 0, -1]]
    assert light.emission.tolist() == [[CEILING_LIGHT]]
    assert not only(scene, *WALLS, "low box", "tall box").emission.any()


def test_cornell_box():
    scene = rd.load_scene("cornell-box")
    assert scene.bands == ("red", "green", "blue")
    light = only(scene, "light")
    assert light.area.sum() == pytest.approx(0.130 * 0.105, rel=1e-9)
    np.testing.assert_allclose(light.normal, np.broadcast_to([0, -1, 0], light.normal.shape), atol=1e-12)
    np.testing.assert_allclose(light.emission, np.broadcast_to(np.pi * np.array([17, 12, 4]), light.emission.shape), rtol=1e-12)
    middle = np.array([0.278, 0.274, 0.280])
    for name in ("floor", "ceiling", "back wall", "right wall", "left wall"):
        wall = only(scene, name)
        towards = middle - wall.vertices[wall.faces[:, 0]]
        assert (np.einsum("ij,ij->i", wall.normal, towards) > 0).all(), name
    for name, height in (("short block", 0.165), ("tall block", 0.330)):
        block = only(scene, name)
        assert len(open_edges(block).face) == 4
        assert enclosed_volume(block) == pytest.approx(
            only(block, name).area[np.abs(block.normal[:, 1]) > 0.9].sum() * height, rel=0.01
        )


@pytest.mark.parametrize("mean", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("cells", [4, 5])
def test_labyrinth_is_a_furnace(mean, cells):
    scene = labyrinth(mean, cells)
    patches = rd.subdivide(scene, cells=1)
    # with E = 1 - rho on every side in a closed scene, B = 1 solves B = E + rho F B, as the rows of F sum to 1
    np.testing.assert_allclose(patches.emission + patches.reflectance, 1, rtol=0, atol=1e-15)
    assert np.average(patches.reflectance[:, 0], weights=patches.area) == pytest.approx(mean, rel=1e-12)
    assert np.ptp(patches.reflectance) > 0.5 * min(mean, 1 - mean)
    np.testing.assert_allclose(patches.area, 1, rtol=1e-12)
    assert (scene.back != Back.PASSES).all()


@pytest.mark.parametrize("cells", [4, 5])
def test_labyrinth_is_closed_and_looks_inwards(cells):
    scene = labyrinth(0.5, cells)
    shell = scene.take(scene.back == Back.ABSORBS)
    assert enclosed_volume(shell) == pytest.approx(-cells * cells, rel=1e-12)
    assert len(open_edges(shell).face) == 0
    inner = scene.take(scene.back == Back.RADIATES)
    assert inner.n_faces == 11  # metres of wall, 1 m high
    assert (inner.normal[:, 2] == 0).all()
    middle = inner.vertices[inner.faces].mean(axis=1)
    assert ((middle > 0) & (middle < [4, 4, 1])).all()
    assert len(np.unique(middle, axis=0)) == 11


@pytest.mark.parametrize(
    ("arguments", "named"), [((1.0,), "mean_reflectance"), ((0.0,), "mean_reflectance"), ((0.5, 3), "cells")]
)
def test_labyrinth_refuses_nonsense(arguments, named):
    with pytest.raises(ValueError, match=named):
        labyrinth(*arguments)


@pytest.mark.parametrize("name", SCENES)
def test_every_scene_is_the_same_each_time_and_has_a_camera(name):
    scene, again = rd.load_scene(name), rd.load_scene(name)
    assert scene.hash == again.hash
    assert len(scene.cameras) == 1
    assert (scene.emission > 0).any()
    assert np.isfinite(scene.vertices).all()


def test_scenes_differ():
    assert len({rd.load_scene(name).hash for name in SCENES}) == len(SCENES) - 1  # labyrinth is labyrinth-0.5
