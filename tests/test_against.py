"""Light where backs let lines pass: sensors and final gathers find what random walks bring, and closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from light_samples import bulb, lit

import radiosity as rd
from radiosity.image import render
from radiosity.scene.shapes import box, join, quad

pytestmark = pytest.mark.filterwarnings("ignore:.*see mostly backs of surfaces")  # below a shelf that is so
PASSES = int(rd.Back.PASSES)
FLOOR = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
UP, DOWN = quad((-2, -2, 1), (4, 0, 0), (0, 4, 0)), quad((-2, -2, 1), (0, 4, 0), (4, 0, 0))


def passing(scene, *names):
    back = scene.back.copy()
    for name in names:
        back[scene.surface == scene.names.index(name)] = PASSES
    return replace(scene, back=back)


@pytest.mark.parametrize(("sheet", "light"), [(UP, 0.0), (DOWN, 1.0)])
@pytest.mark.parametrize("lamp", ["point", "face"])
def test_a_sheet_between_a_lamp_and_a_sensor(sheet, light, lamp):
    """Light ends on the sheet's front, and goes on through its back: I cos / d² below it, or nothing."""
    faces = [("floor", 0.0, 0.0, [FLOOR]), ("sheet", 0.0, 0.0, [sheet])]
    if lamp == "point":
        scene, expected = lit(*faces, luminaires=(bulb((0, 0, 2), 400 * np.pi),)), 100 / 4
    else:
        lamps = [("lamp", 0.0, 1000.0, [quad((-0.05, -0.05, 2), (0, 0.1, 0), (0.1, 0, 0))])]
        scene, expected = join([*faces, *lamps], source="lamp"), 1000 * 0.01 / (4 * np.pi)
    scene = passing(scene, "sheet")
    solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=5_000, replicates=2)
    found = rd.measure(solution, rd.Sensors.of([[0, 0, 0]], [[0, 0, 1]]), rays=20_000).irradiance[0, 0]
    assert found == pytest.approx(light * expected, rel=0.01)


def test_sensors_measure_what_walks_bring():
    """The mean over points of each patch is the patch's irradiance, in a room with sheets of both kinds. Noise: 1 % each."""
    parts = [
        ("walls", 0.6, 0.0, box((0, 0, 0), (2, 2, 2), inward=True)),
        ("lamp", 0.3, 10.0, [quad((0.4, 0.4, 1.95), (0, 1.2, 0), (1.2, 0, 0))]),
        ("shelf", 0.7, 0.0, [quad((0, 0, 0.6), (1, 0, 0), (0, 2, 0))]),
        ("awning", 0.7, 0.0, [quad((1, 0, 0.9), (0, 2, 0), (1, 0, 0))]),
    ]
    scene = passing(join(parts, source="sheets"), "lamp", "shelf", "awning")
    patches = rd.subdivide(scene, cells=1)
    solution = rd.solve(patches, "random-walk", rays=2_000_000, replicates=4)
    draw, (origin, first, second) = np.random.default_rng(5), scene.frames
    count = 256
    u, v = 0.002 + 0.996 * draw.random((2, len(patches), count, 1))
    points = origin[:, None] + u * first[:, None] + v * second[:, None]
    sensors = rd.Sensors.of(points.reshape(-1, 3), np.repeat(scene.normal, count, axis=0))
    found = rd.measure(solution, sensors, rays=64 * len(sensors)).irradiance.reshape(len(patches), count).mean(axis=1)
    np.testing.assert_allclose(found, solution.irradiance[:, 0], rtol=0.03, atol=0.02 * solution.irradiance.mean())
    named = {scene.names[scene.surface[face]]: found[face] for face in range(len(found))}
    assert named["awning"] > 0.2  # lit by the floor, whose light has passed nothing


def test_two_faces_in_one_plane_are_a_wall():
    """Rooms on both sides of a wall of two faces, back to back: no light comes through, though both backs let lines pass."""
    wall, other = quad((1, 0, 0), (0, 0, 1), (0, 1, 0)), quad((1, 0, 0), (0, 1, 0), (0, 0, 1))
    parts = [
        ("rooms", 0.0, 0.0, box((0, 0, 0), (2, 1, 1), inward=True)),
        ("wall", 0.5, 0.0, [wall]),
        ("other", 0.5, 0.0, [other]),
        ("lamp", 0.0, 10.0, [quad((1.2, 0.2, 0.9), (0, 0.6, 0), (0.6, 0, 0))]),
    ]
    scene = join(parts, source="two rooms")
    sensor = rd.Sensors.of([[0.5, 0.5, 0.5], [1.5, 0.5, 0.3]], [[1, 0, 0], [-1, 0, 0]])
    for names in (("wall", "other"), ("wall",)):
        solution = rd.solve(rd.subdivide(passing(scene, *names), cells=1), "random-walk", rays=20_000, replicates=2)
        found = rd.measure(solution, sensor, rays=20_000).irradiance[:, 0]
        assert found[0] == 0
        assert found[1] > 0.1


def test_a_picture_through_a_back_that_passes():
    """The camera below a shelf sees through its back; the floor that it sees has the shelf's shadow."""
    scene = passing(lit(("floor", 0.5, 0.0, [FLOOR]), ("shelf", 0.5, 0.0, [UP]), luminaires=(bulb((0, 0, 2), 400.0),)), "shelf")
    solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=5_000, replicates=2)
    below = rd.Camera((0, 0, 0.5), (0, 0, 2), (0, 1, 0), 40.0, 4, 3)
    floor = rd.Camera((0, 0, 0.5), (0, 0, 0), (0, 1, 0), 40.0, 4, 3)
    above = rd.Camera((0, 0, 1.5), (0, 0, 0), (0, 1, 0), 40.0, 4, 3)
    with pytest.warns(rd.RadiosityWarning, match="the picture is empty"):
        shown = [render(solution, camera=camera, final_gather=64, scale=1.0) for camera in (below, floor, above)]
    assert not shown[0].any()
    assert not shown[1].any()
    assert shown[2].all()


def test_scenes_without_such_backs_keep_their_bits():
    """A sheet that absorbs and a sheet of which nobody sees the back give the same values."""
    parts = [
        ("walls", 0.6, 0.0, box((0, 0, 0), (2, 2, 2), inward=True)),
        ("lamp", 0.0, 10.0, [quad((0.4, 0.4, 1.95), (0, 1.2, 0), (1.2, 0, 0))]),
    ]
    scene = join(parts, source="room")
    sensor = rd.Sensors.of([[0.5, 0.5, 0.2], [1.5, 0.5, 0.3]], [[1, 0, 0], [-1, 0, 0]])
    found = []
    for one in (scene, passing(scene, "walls")):
        solution = rd.solve(rd.subdivide(one, cells=1), "random-walk", rays=20_000, replicates=2)
        found.append(rd.measure(solution, sensor, rays=20_000).irradiance)
    np.testing.assert_array_equal(*found)
