"""Gather takes lights without area: luminaires and suns by shadow rays, the sky where lines escape and through openings."""

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.gather import targets
from radiosity.problem.lights.openings import Openings
from radiosity.scene.lights.luminaire import Luminaire
from radiosity.scene.lights.model import Lights
from radiosity.scene.lights.sky import Sky
from radiosity.scene.lights.sun import Sun
from radiosity.scene.lights.web import Web
from radiosity.scene.shapes import box, join, quad

ALIKE = Web(np.zeros(1), np.array([0.0, 180]), np.ones((1, 2)))
DOWN = Web(np.zeros(1), np.array([0.0, 90]), np.array([[1.0, 0]]))
HANGING = np.diag([1.0, -1, -1])  # gamma = 0 looks down
OVERCAST = np.array([[[0.0]], [[0.0]], [[1 / 3]], [[1.0]]])  # (1 + 2 sin e) / 3 of the zenith's
WINDOW = np.array([[(0, 1, 1), (0, 2, 1), (0, 2, 2), (0, 1, 2)]], float)
QUANTA = 30_000


def lamp(position, web: Web = ALIKE, power=1.0, axes=HANGING, **more) -> Luminaire:
    return Luminaire("lamp", np.array(position, float), axes, web, np.atleast_1d(power), np.zeros(3), **more)


def lit(scene: rd.Scene, *luminaires: Luminaire, suns=(), sky=None, openings=None, cells: int = 1) -> rd.Patches:
    return rd.subdivide(replace(scene, lights=Lights(luminaires, suns, sky, openings)), cells=cells)


def room(reflectance=0.5) -> rd.Scene:
    """A closed unit cube."""
    return join([("walls", reflectance, 0.0, box((0, 0, 0), (1, 1, 1), inward=True))], source="room")


def gathered(patches: rd.Patches, quanta: int = QUANTA, **more) -> rd.Solution:
    return rd.solve(patches, "gather", quanta=quanta, **more)


def far_off(one: rd.Solution, other: rd.Solution) -> np.ndarray:
    """Differences in combined standard errors."""
    errors = np.hypot(one.irradiance_standard_error, other.irradiance_standard_error)
    return (one.irradiance - other.irradiance) / errors


def test_a_point_light_between_black_walls_obeys_the_inverse_square_and_the_cosine():
    position = np.array([0.3, 0.45, 0.6])
    patches = lit(room(0.0), lamp(position, power=40.0), cells=8)
    found = gathered(patches, quanta=150_000)
    cells = (np.arange(64) + 0.5) / 64  # midpoints of each patch: 8 by 8 points
    s, t = (x.ravel() for x in np.meshgrid(cells[:8] * 8, cells[:8] * 8))
    corners = patches.corners
    points = corners[:, :1] + s[:, None] * (corners[:, 1] - corners[:, 0])[:, None]
    points = points + t[:, None] * (corners[:, 3] - corners[:, 0])[:, None]
    way = position - points
    square = (way**2).sum(axis=2)
    expected = 40 / (4 * np.pi) * ((way * patches.normal[:, None]).sum(axis=2) / square**1.5).mean(axis=1)
    np.testing.assert_allclose(found.irradiance[:, 0], expected, rtol=4e-3)
    off = (found.irradiance[:, 0] - expected) / np.hypot(found.irradiance_standard_error[:, 0], 2e-4 * expected)
    assert np.abs(off).max() < 8  # Student's t with 7 degrees of freedom, 384 patches: above in 3 of 100 runs
    assert abs(float(found.irradiance[:, 0] @ patches.area) / 40 - 1) < 3e-4  # all of it arrives


def test_gather_and_random_walk_agree_on_lights_of_all_kinds():
    floor = join(
        [
            ("floor", 0.6, 0.0, [quad((0, 0, 0), (4, 0, 0), (0, 4, 0))]),
            ("wall", 0.3, 0.0, [quad((2, 0, 0), (0, 4, 0), (0, 0, 1))]),
            ("panel", 0.0, 2.0, [quad((1, 1, 2), (0, 1, 0), (1, 0, 0))]),
        ],
        source="yard",
    )
    sky, sun = Sky("sky", OVERCAST, np.eye(3)), Sun("sun", np.array([0.6, 0.0, 0.8]), np.array([3.0]))
    patches = lit(floor, lamp((3, 2, 0.5), DOWN, 5.0), suns=(sun,), sky=sky, cells=4)
    one, other = gathered(patches), rd.solve(patches, "random-walk", rays=4e6, seed=1)
    off = far_off(one, other)
    assert np.abs(off).max() < 7
    assert off.std() < 1.6
    assert one.error < 0.01


def room_with_window() -> rd.Scene:
    """A room of 4 x 3 x 3 m with a window of 1 m2; walls are seen from inside, and black outside."""
    around = [((0, 0, 0), (0, 3, 0), (0, 0, 1)), ((0, 0, 2), (0, 3, 0), (0, 0, 1))]
    around += [((0, 0, 1), (0, 1, 0), (0, 0, 1)), ((0, 2, 1), (0, 1, 0), (0, 0, 1))]
    inside = [one for one in box((0, 0, 0), (4, 3, 3), inward=True) if np.ptp(np.asarray(one)[:, 0]) > 0 or one[0][0] > 1]
    assert len(inside) == 5
    return join([("walls", 0.5, 0.0, [*inside, *(quad(*one) for one in around)])], source="room with a window")


@pytest.fixture(scope="module")
def windowed() -> rd.Scene:
    return room_with_window()


@pytest.fixture(scope="module")
def with_opening(windowed) -> rd.Solution:
    return gathered(lit(windowed, sky=Sky("sky", OVERCAST, np.eye(3)), openings=WINDOW, cells=5), quanta=60_000)


def test_openings_change_errors_alone(windowed, with_opening):
    without = gathered(lit(windowed, sky=Sky("sky", OVERCAST, np.eye(3)), cells=5), quanta=60_000)
    off = far_off(with_opening, without)
    assert np.abs(off).max() < 8
    assert abs(off.mean()) < 0.5
    assert with_opening.error < 0.25 * without.error


@pytest.mark.parametrize("fault", ["both count", "cosine lines never count", "another opening"])
def test_wrong_weights_of_openings_are_noticed(windowed, with_opening, fault, monkeypatch):
    """Shadow rays through openings and cosine lines share the light of the sky among them: each direction counts once."""
    monkeypatch.setattr(targets, "KERNEL", 0.02)  # so that cosine lines have much of it
    if fault == "another opening":
        nearest = Openings.nearest
        monkeypatch.setattr(Openings, "nearest", lambda *a: (nearest(*a)[0] + 1, *nearest(*a)[1:]))
    else:
        density, factor = targets.Chances.density_of, 0.0 if fault == "both count" else 1e9
        monkeypatch.setattr(targets.Chances, "density_of", lambda *a: density(*a) * factor)  # only cosine lines ask for it
    sky, where = Sky("sky", OVERCAST, np.eye(3)), with_opening.irradiance[:, 0] > 0
    wrong = gathered(lit(windowed, sky=sky, openings=WINDOW, cells=5), quanta=60_000)
    assert abs(wrong.irradiance[where].mean() / with_opening.irradiance[where].mean() - 1) > 0.02


def test_a_sun_throws_a_sharp_shadow_and_obeys_the_cosine():
    scene = join(
        [
            ("floor", 0.0, 0.0, [quad((0, 0, 0), (4, 0, 0), (0, 4, 0))]),
            ("roof", 0.0, 0.0, [quad((1, 1, 1), (2, 0, 0), (0, 2, 0))]),
        ],
        source="yard",
    )
    direction = np.array([1.0, 0, 1]) / 2**0.5  # the roof's shadow is one metre towards -x
    found = gathered(lit(scene, suns=(Sun("sun", direction, np.array([700.0]), 0.0),), cells=4))
    floor = found.patches.centroid[:, 2] == 0
    x, y, _ = found.patches.centroid[floor].T
    shadow = (x < 2) & (abs(y - 2) < 1)
    expected = np.where(shadow, 0.0, 700 / 2**0.5)
    np.testing.assert_allclose(found.irradiance[floor, 0], expected, rtol=1e-4, atol=1e-3)


def test_bands_of_lights_are_kept_apart():
    colors = np.array([1.0, 2.0, 0.5])
    scene = join([("walls", (0.2, 0.5, 0.8), (0, 0, 0), box((0, 0, 0), (1, 1, 1), inward=True))], source="room")
    found = gathered(lit(scene, lamp((0.5, 0.5, 0.5), power=colors), cells=3), quanta=10_000)
    mean = found.irradiance.T @ found.patches.area / found.patches.area.sum()
    np.testing.assert_allclose(mean, colors / 6 / (1 - np.array([0.2, 0.5, 0.8])), rtol=0.01)  # all light is absorbed in the end


def test_bits_do_not_depend_on_stages_and_a_run_goes_on_from_a_file(tmp_path):
    sky, sun = Sky("sky", OVERCAST, np.eye(3), "overcast"), Sun("sun", np.array([0.6, 0.0, 0.8]), np.array([3.0]))
    more = {"suns": (sun,), "sky": sky, "openings": WINDOW, "cells": 3}
    patches = lit(room(), lamp((0.5, 0.5, 0.5), soft=True, group="a", source="b"), lamp((0.2, 0.5, 0.5), DOWN, 2.0), **more)
    whole = gathered(patches, quanta=8_000)
    gathered(patches, quanta=2_000).save(tmp_path / "part.npz")
    part = rd.load_solution(tmp_path / "part.npz")
    assert part.patches.scene.hash == patches.scene.hash
    lights = part.patches.scene.lights
    assert [one.name for one in lights.all] == ["lamp", "lamp", "sun", "sky"]
    assert lights.luminaires[0].soft
    assert (lights.luminaires[0].group, lights.luminaires[0].source) == ("a", "b")
    again = rd.solve(part.patches, "gather", quanta=8_000, resume=part)
    np.testing.assert_array_equal(again.irradiance, whole.irradiance)
    np.testing.assert_array_equal(again.irradiance_standard_error, whole.irradiance_standard_error)


def test_a_light_on_a_surface_is_not_behind_it():
    """A luminaire in the plane of a ceiling, and one that touches it from below."""
    scene = room(0.0)
    found = gathered(lit(scene, lamp((0.5, 0.5, 1.0), DOWN, 3.0), cells=4))
    assert abs(float(found.irradiance[:, 0] @ found.patches.area) / 3 - 1) < 2e-3
    walk = rd.solve(found.patches, "random-walk", rays=2e5)
    assert abs(float(walk.irradiance[:, 0] @ found.patches.area) / 3 - 1) < 2e-3


def test_auto_takes_gather_and_other_methods_refuse_lights_by_name():
    patches = lit(room(), lamp((0.5, 0.5, 0.5)))
    assert rd.solve(patches, rays=50_000).provenance["auto"]["chosen"] == "gather"
    for method in ("particle-tracing", "stochastic-jacobi", "transillumination", "full-matrix", "hierarchical"):
        with pytest.raises(rd.MethodError, match=r"lights without area: 'lamp'; take --method gather"):
            rd.solve(patches, method, **({} if method in ("full-matrix", "hierarchical") else {"rays": 1000}))


def test_many_luminaires_are_chosen_by_what_they_send():
    """A hundred lamps over a floor, of which each patch sees a few well."""
    floor = join([("floor", 0.0, 0.0, [quad((0, 0, 0), (20, 0, 0), (0, 20, 0))])], source="hall")
    places = [(x, y, 3) for x in range(1, 20, 2) for y in range(1, 20, 2)]
    many = gathered(lit(floor, *(lamp(place, DOWN) for place in places), cells=20), quanta=20_000)
    way = np.array(places, float) - np.append(many.patches.centroid[:, :2], np.zeros((len(many.patches), 1)), 1)[:, None]
    square = (way**2).sum(axis=2)
    cosine = way[..., 2] / square**0.5
    angle = np.arccos(cosine)
    expected = ((1 - angle / (np.pi / 2)) / DOWN.flux * cosine / square).sum(axis=1)
    inner = np.abs(many.patches.centroid[:, :2] - 10).max(axis=1) < 7
    relative = many.irradiance[inner, 0] / expected[inner] - 1
    assert np.sqrt((relative**2).mean()) < 0.05  # 0.027; clusters of 256 patches chose lamps so badly that it was 0.3
    assert np.abs(relative * expected[inner] / many.irradiance_standard_error[inner, 0]).max() < 9
    assert many.error < 0.1
