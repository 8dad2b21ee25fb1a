"""Suns and the sky as rows that fire: closed forms of plates, a box's shadow, what lines see, integers in every order."""

from dataclasses import replace

import drjit as dr
import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.table import make
from radiosity.device.backend import choose, upload
from radiosity.problem.lights.ball import Ball
from radiosity.problem.lights.sky import SkyRows
from radiosity.problem.lights.suns import Suns
from radiosity.problem.lights.together import lights_of
from radiosity.problem.model import Problem
from radiosity.scene.lights.model import Lights
from radiosity.scene.lights.sky import Sky, row_sines
from radiosity.scene.lights.sun import Sun
from radiosity.scene.shapes import box, join, quad
from radiosity.solution.errors import mean_and_error

REPLICATES = 8
Z_UP = np.eye(3)


def sky(rows, axes=Z_UP) -> Sky:
    """A sky from radiances, (n_elevations, n_azimuths) or with bands."""
    table = np.asarray(rows, np.float64)
    return Sky("sky", table[..., None] if table.ndim == 2 else table, axes)


def overcast(zenith: float, ground: float = 0.0) -> Sky:
    """CIE's overcast sky, zenith (1 + 2 sin e) / 3, which two rows hold exactly."""
    return sky([[ground], [ground], [zenith / 3], [zenith]])


def plate(normal=(0.0, 0.0, 1.0), reflectance: float | np.ndarray = 0.0) -> rd.Scene:
    """A square of 1 m² whose front looks along a normal."""
    normal = np.asarray(normal) / np.linalg.norm(normal)
    first = np.cross(normal, (0.3, 0.4, 0.5))
    first /= np.linalg.norm(first)
    return join([("plate", reflectance, 0.0, [quad((2, 3, 4), first, np.cross(normal, first))])], source="plate")


def under(scene: rd.Scene, *suns: Sun, sky: Sky | None = None) -> rd.Scene:
    return replace(scene, lights=Lights(suns=suns, sky=sky))


def run(scene, geometry_of, quanta: int = 1 << 16, cells: int = 1, **choices):
    patches = rd.subdivide(scene, cells=cells)
    algorithm = make(geometry_of(patches), Problem.of(patches), rd.Method(**choices), 3, REPLICATES)
    algorithm.advance(quanta, lambda lines: None)
    return algorithm


def irradiance(algorithm, group: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """W/m² of each patch and their standard errors."""
    values, unit = algorithm.tally.irradiance(algorithm.problem, algorithm.capture(), group)
    mean, error = mean_and_error(values)
    area = algorithm.problem.patches.area
    return mean * unit / area, error * unit / area


FACADE = np.pi / 6 + 4 / 9  # the integral of (1 + 2 z) / 3 times cos e cos a over a quarter of the sphere


@pytest.mark.parametrize(
    ("normal", "light", "wanted"),
    [
        ((0, 0, 1), sky([[0], [0], [3.0], [3.0]]), 3 * np.pi),
        ((0, 0, 1), overcast(3.0, ground=5.0), 3 * np.pi * 7 / 9),
        ((1, 0, 0), overcast(3.0), 3 * FACADE),
        ((1, 0, 0), sky([[2.0], [2.0], [0], [0]]), np.pi),
        ((0, 0, -1), overcast(3.0, ground=2.0), 2 * np.pi),
        ((0, 1, 0), replace(overcast(3.0), axes=np.roll(Z_UP, 1, axis=0)), 3 * np.pi * 7 / 9),
    ],
    ids=["uniform", "overcast", "facade", "facade-and-ground", "from-below", "y-up"],
)
def test_plates_receive_their_integral_of_the_sky(normal, light, wanted, geometry_of):
    mean, error = irradiance(run(under(plate(normal), sky=light), geometry_of))
    assert abs(mean[0] - wanted) < 5.4 * error[0]  # Student's t with 7 degrees: 1 in 1000
    assert error[0] < 0.01 * wanted


def test_a_sky_that_varies_with_azimuth_lights_each_side_by_its_own(geometry_of, random):
    """A table of random entries against a sum over its look-up on the host."""
    light = sky(random.random((8, 7)))
    z = (np.arange(400) + 0.5) / 200 - 1
    a = (np.arange(800) + 0.5) * np.pi / 400
    flat = np.sqrt(1 - z**2)[:, None]
    directions = np.stack([flat * np.cos(a), flat * np.sin(a), np.broadcast_to(z[:, None], (400, 800))], axis=-1)
    seen = light.at(directions)[..., 0]
    assert seen.mean() * 4 * np.pi == pytest.approx(light.flux[0], rel=1e-4)
    assert (seen * np.maximum(z, 0)[:, None]).mean() * 4 * np.pi == pytest.approx(light.horizontal[0], rel=1e-4)
    for normal in ((1, 2, 0.5), (-2, 0.3, -1)):
        wanted = (seen * np.maximum(directions @ np.array(normal) / np.linalg.norm(normal), 0)).mean() * 4 * np.pi
        mean, error = irradiance(run(under(plate(normal), sky=light), geometry_of))
        assert abs(mean[0] - wanted) < 5.4 * error[0]
        assert error[0] < 0.01 * wanted


def device_side(lights, scene, geometry_of, function):
    """Prepare lights for a scene and return what a function of Dr.Jit's types and the geometry gives."""
    geometry = geometry_of(rd.subdivide(scene, cells=1))
    lights.prepare(geometry)
    return function(choose().types, geometry)


def test_lines_leave_in_proportion_to_the_radiance_that_lines_see(geometry_of, random):
    """Directions by the inverse of the table's integral: each strip of z and azimuth has its share of the flux (1e-3)."""
    light, n = sky(random.random((10, 6, 1)) ** 4), 512
    scene = plate()
    rows = SkyRows(light, 1, Ball.about(scene))

    def directions(types, geometry):
        first, second = (x.ravel() for x in np.meshgrid(*2 * [(np.arange(n) + 0.5) / n], indexing="ij"))
        towards, _ = rows.fired.draw(types.UInt32(0), *(upload(types.Float, x.astype("f4")) for x in (first, second)))
        seen = rows.radiance(towards)[0]
        return np.array(towards).T, np.array(seen)

    towards, seen = device_side(rows, scene, geometry_of, directions)
    assert np.allclose(np.linalg.norm(towards, axis=1), 1, atol=1e-6)
    assert np.allclose(seen, light.at(towards.astype(np.float64))[:, 0], atol=2e-4)
    # the mean of 1 / radiance over directions in proportion to it is 4 pi / flux, and that of z / radiance is zero
    assert (1 / seen).mean() == pytest.approx(4 * np.pi / light.flux[0], rel=3e-3)
    assert (towards / seen[:, None]).mean(axis=0) == pytest.approx(np.zeros(3), abs=3e-3 * 4 * np.pi / light.flux[0])
    outer = (towards[:, :, None] * towards[:, None, :] / seen[:, None, None]).mean(axis=0)
    assert outer == pytest.approx(np.eye(3) * 4 * np.pi / 3 / light.flux[0], abs=5e-3 * 4 * np.pi / light.flux[0])


def test_lines_of_a_sky_go_through_the_whole_ball_and_begin_before_it(geometry_of, random):
    scene, numbers = plate((1, 2, 3)), random.random((4, 4096)).astype("f4")
    rows = SkyRows(overcast(3.0), 1, Ball.about(scene))

    def lines(types, geometry):
        origin, direction = rows.leave(types.UInt32(0), [upload(types.Float, x) for x in numbers])
        place = geometry.bvh.place(rows.ball.centre), rows.ball.radius * geometry.bvh.scale
        return (np.array(origin).T - place[0]) / place[1], np.array(direction).T

    origin, direction = device_side(rows, scene, geometry_of, lines)
    assert np.einsum("ij,ij->i", origin, direction) == pytest.approx(-np.ones(4096), abs=1e-5)
    across = np.linalg.norm(origin + direction, axis=1)
    assert across == pytest.approx(np.sqrt(numbers[3]), abs=1e-5)
    corners = (scene.vertices - rows.ball.centre) / rows.ball.radius
    assert 1 - 1e-5 < np.linalg.norm(corners, axis=1).max() < 1


TOWARDS = np.array([0.3, -0.4, 0.866])
TOWARDS /= np.linalg.norm(TOWARDS)


@pytest.mark.parametrize("diameter", [0.0, 0.533, 60.0])
def test_a_plate_under_the_sun_receives_by_the_cosine(diameter, geometry_of):
    """The cosine law holds for a disc of any size, as long as all of it is above the plate's horizon."""
    mean, error = irradiance(run(under(plate((0.1, 0.2, 1)), Sun("sun", TOWARDS, np.array([800.0]), diameter)), geometry_of))
    wanted = 800 * TOWARDS @ np.array([0.1, 0.2, 1]) / np.sqrt(1.05)
    assert abs(mean[0] - wanted) < 5.4 * error[0]
    assert error[0] < 0.005 * wanted


def test_a_box_throws_its_shadow(geometry_of):
    """Sun at 45 degrees: cells of the ground behind a box of height 1 are dark for a length of 1, and all others lit."""
    ground = [quad((-3, -3, 0), (6, 0, 0), (0, 6, 0))]
    scene = join([("ground", 0.0, 0.0, ground), ("box", 0.0, 0.0, box((-0.5, -0.5, 0), (0.5, 0.5, 1)))], source="box")
    sun = Sun("sun", np.array([1.0, 0.0, 1.0]), np.array([100.0]), 0.0)
    algorithm = run(under(scene, sun), geometry_of, cells=12)  # of 0.5 m
    mean, error = irradiance(algorithm)
    cell = mean[:144].reshape(12, 12)  # rows along y
    dark = np.zeros((12, 12), bool)
    dark[5:7, 3:7] = True  # x from -1.5 to 0.5, y from -0.5 to 0.5
    assert (cell[dark] == 0).all()
    assert cell[~dark].mean() == pytest.approx(100 / np.sqrt(2), rel=0.01)
    assert (np.abs(cell[~dark] - 100 / np.sqrt(2)) < 6.5 * error[:144].reshape(12, 12)[~dark]).all()  # 140 cells: 5 % by chance


def test_what_arrives_from_suns_is_what_leaves_them(geometry_of, random):
    """The density times the power is the irradiance; directions fill the disc evenly, and are those of the lines."""
    suns = (Sun("a", TOWARDS, np.array([800.0]), 30.0), Sun("b", np.array([0, 0, 2.0]), np.array([5.0])))
    scene, numbers = plate(), random.random((4, 20000)).astype("f4")
    rows = Suns.of(suns, 1, Ball.about(scene))

    def sides(types, geometry):
        light, drawn = dr.arange(types.UInt32, 20000) & 1, [upload(types.Float, x) for x in numbers]
        away, distance, density = rows.arrive(light, types.Array3f(0), drawn)
        _, direction = rows.leave(light, [drawn[2], drawn[3], drawn[0], drawn[1]])
        return np.array(away).T, np.array(direction).T, distance[0], density[0] * geometry.bvh.scale**2

    away, direction, distance, density = device_side(rows, scene, geometry_of, sides)
    assert np.array_equal(away, -direction)
    assert distance == np.inf
    cosine = away[::2] @ TOWARDS
    assert cosine.min() > np.cos(np.radians(15)) - 1e-6
    assert np.mean(cosine) == pytest.approx((1 + np.cos(np.radians(15))) / 2, abs=3e-4)
    assert rows.power[:, 0] * density * [np.mean(cosine), 1] == pytest.approx([800, 5], rel=1e-3)
    assert away[1::2, 2].min() > np.cos(np.radians(0.267)) - 1e-6


def test_bands_of_the_sky_and_the_sun_are_each_its_own(geometry_of):
    """Radiances that are not in proportion: each band receives its own integral; those in proportion share a row."""
    table = np.zeros((4, 1, 3))
    table[2, 0], table[3, 0] = (1, 1, 2), (3, 1, 6)  # (1 + 2 z), 1, and twice the first
    scene = under(plate(reflectance=np.array([0.5, 0.3, 0.2])), Sun("sun", TOWARDS, np.array([1.0, 2.0, 0.0])), sky=sky(table))
    lights = lights_of(scene, 3)
    assert lights is not None
    assert len(lights.power) == 3
    assert ((lights.power > 0).sum(axis=1) == (2, 2, 1)).all()
    algorithm = run(scene, geometry_of)
    sunny = TOWARDS[2]
    wanted = np.array([7 / 3 * np.pi + sunny, np.pi + 2 * sunny, 14 / 3 * np.pi])
    for band in range(3):
        group, scale = algorithm.problem.groups.index[band], algorithm.problem.groups.scale[band]
        mean, error = irradiance(algorithm, group)
        assert abs(mean[0] * scale - wanted[band]) < 5.4 * error[0] * scale
        assert error[0] * scale < 0.02 * wanted[band]
        assert algorithm.tally.books(algorithm.problem, algorithm.capture(), group)["closes"]


def test_the_energy_balance_closes_and_one_band_lights_all(geometry_of):
    ground, tower = [quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))], box((-0.5, -0.5, 0), (0.5, 0.5, 2))
    scene = join([("ground", 0.5, 0.1, ground), ("tower", 0.3, 0.0, tower)], source="tower")
    scene = under(scene, Sun("sun", TOWARDS, np.array([3.0])), sky=overcast(1.0, ground=0.2))
    algorithm = run(scene, geometry_of, cells=4)
    book = algorithm.tally.books(algorithm.problem, algorithm.capture(), 0)
    assert book["closes"]
    ball = Ball.about(scene)
    assert book["emitted"] == pytest.approx(1.6 + ball.disc * (3 + 4 * np.pi / 3 + 0.4 * np.pi), rel=1e-4)
    assert book["escaped"] > book["emitted"] / 2
    rows = lights_of(scene, 2)
    assert rows is not None
    assert (rows.power[:, 0] == rows.power[:, 1]).all()


@pytest.mark.parametrize("order", ["depth-first", "well-distributed"])
def test_integers_do_not_depend_on_the_order(geometry_of, order):
    scene = under(plate(reflectance=0.7), Sun("sun", TOWARDS, np.array([3.0])), sky=overcast(1.0))
    one, other = (run(scene, geometry_of, 1 << 12, order=o).capture().arrays() for o in ("breadth-first", order))
    assert all(np.array_equal(one[key], other[key]) for key in ("arrivals", "fired", "missed"))


def test_the_power_of_a_line_is_that_of_the_sky_where_nothing_else_emits(geometry_of):
    """It was 0, and with it the error of all patches where no line had hit any."""
    algorithm = run(under(plate(), sky=overcast(1.0)), geometry_of, 1 << 10)
    power = algorithm.tally.line(algorithm.problem, algorithm.capture(), 0)
    assert power == pytest.approx(4 / 3 * np.pi * Ball.about(plate()).disc / 1024)


def test_rows_of_a_table_have_the_sines_of_their_elevations():
    assert row_sines(6) == pytest.approx(np.sin(np.radians([-90, -45, 0, 0, 45, 90])))


def test_a_black_sky_is_no_light():
    assert lights_of(under(plate(), sky=overcast(0.0)), 1) is None
