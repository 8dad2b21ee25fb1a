"""Luminaires as rows: directions in proportion to the web, and light that arrives as they send it."""

from dataclasses import replace

import drjit as dr
import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.table import make
from radiosity.problem.lights.luminaires import Luminaires
from radiosity.problem.lights.web_tables import WebTables
from radiosity.problem.model import Problem
from radiosity.scene.lights.luminaire import Luminaire
from radiosity.scene.lights.model import Lights
from radiosity.scene.lights.web import Web
from radiosity.scene.shapes import box, join
from radiosity.solution.errors import mean_and_error

REPLICATES, QUANTA = 4, 1 << 15


def uneven() -> Web:
    """Entries at uneven angles, a third of them zero, in no way symmetric."""
    random = np.random.Generator(np.random.Philox(3))
    table = random.random((6, 8)) * (random.random((6, 8)) > 1 / 3)
    table[-1] = table[0]
    return Web(np.array([0.0, 20, 95, 180, 300, 360]), np.array([0.0, 4, 30, 31, 90, 100, 150, 180]), table)


WEBS = {
    "alike": Web(np.zeros(1), np.array([0.0, 180]), np.ones((1, 2))),
    "downwards": Web(np.zeros(1), np.array([0.0, 10, 90]), np.array([[3.0, 2, 0]])),
    "upwards": Web(np.zeros(1), np.array([90.0, 180]), np.array([[0.0, 5]])),
    "beam": Web(np.zeros(1), np.array([0.0, 1.5, 1.6]), np.array([[1e5, 1e5, 0]])),
    "uneven": uneven(),
}
TURNED = np.linalg.qr(np.random.Generator(np.random.Philox(5)).normal(size=(3, 3)))[0]
TURNED[2] *= np.linalg.det(TURNED)


def luminaire(web: Web, position=(0.0, 0.0, 0.0), axes=None, power=1.0, **more) -> Luminaire:
    size = more.pop("size", np.zeros(3))
    axes = np.eye(3) if axes is None else axes
    return Luminaire("lamp", np.array(position), axes, web, np.atleast_1d(power), np.asarray(size), **more)


def intensity(web: Web, plane: np.ndarray, gamma: np.ndarray) -> np.ndarray:
    """The bilinear intensity in directions, degrees, over the web's flux."""
    planes = np.array([0.0, 360]) if len(web.planes) == 1 else web.planes
    rows = np.stack([np.interp(gamma, web.gamma, row, left=0, right=0) for row in web.intensity])
    rows = np.broadcast_to(rows, (len(planes), len(gamma)))
    at = np.clip(np.searchsorted(planes, plane, side="right") - 1, 0, len(planes) - 2)
    part = (plane - planes[at]) / (planes[at + 1] - planes[at])
    each = np.arange(len(gamma))
    return ((1 - part) * rows[at, each] + part * rows[at + 1, each]) / web.flux


def angles(directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """C and gamma, degrees, of unit vectors (n, 3) in the luminaire's frame."""
    gamma = np.degrees(np.arctan2(np.hypot(directions[:, 0], directions[:, 1]), directions[:, 2]))
    return np.degrees(np.arctan2(directions[:, 1], directions[:, 0])) % 360, gamma


@pytest.fixture(scope="module")
def walls() -> rd.Patches:
    return rd.subdivide(join([("walls", 0.0, 0.0, box((0, 0, 0), (1, 1, 1), inward=True))], source="room"), cells=6)


def with_lights(patches: rd.Patches, *lamps: Luminaire, reflectance: float = 0.0) -> rd.Patches:
    scene = patches.scene
    scene = replace(scene, reflectance=scene.reflectance * 0 + reflectance, lights=Lights(lamps), photometric=True)
    return rd.subdivide(scene, cells=int(patches.columns[0]))


def run(patches: rd.Patches, geometry_of, quanta: int = QUANTA, **choices):
    algorithm = make(geometry_of(patches), Problem.of(patches), rd.Method(**choices), 3, REPLICATES)
    algorithm.advance(quanta, lambda lines: None)
    return algorithm


def received(algorithm) -> tuple[np.ndarray, np.ndarray]:
    """lm of each patch and their standard errors."""
    values, unit = algorithm.tally.irradiance(algorithm.problem, algorithm.capture(), 0)
    mean, error = mean_and_error(values)
    return mean * unit, error * unit


def points_of(patches: rd.Patches, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The middles of n x n parts of each patch, (n_patches * n * n, 3), with their areas and unit normals."""
    scene, middles = patches.scene, (np.arange(n) + 0.5) / n
    origin, first, second = (x[patches.face] for x in scene.frames)
    column, row, _ = (np.asarray(x) for x in patches.places(slice(0, len(patches))))
    u = (column[:, None, None] + middles[:, None]) / patches.columns[patches.face][:, None, None]
    v = (row[:, None, None] + middles[None, :]) / patches.rows[patches.face][:, None, None]
    points = origin[:, None, None] + first[:, None, None] * u[..., None] + second[:, None, None] * v[..., None]
    normal = np.repeat(scene.normal[patches.face], n * n, axis=0)
    return points.reshape(-1, 3), np.repeat(patches.area / n**2, n * n), normal


def expected(patches: rd.Patches, lamp: Luminaire, n: int) -> np.ndarray:
    """lm that black patches receive, by the law of the inverse square and the cosine at n x n points of each."""
    points, area, normal = points_of(patches, n)
    way = points - lamp.position
    square = (way**2).sum(axis=1)
    cosine = -np.einsum("ij,ij->i", way, normal) / np.sqrt(square)
    share = intensity(lamp.web, *angles(way / np.sqrt(square)[:, None] @ lamp.axes.T)) / square
    return lamp.power[0] * (share * cosine * area).reshape(len(patches), -1).sum(axis=1)


class Still:
    """A BVH that leaves coordinates as they are."""

    centre, scale = np.zeros(3), 1.0


@pytest.fixture(scope="module")
def device():
    from radiosity.device.backend import choose

    return choose()


def prepared(device, *lamps: Luminaire) -> Luminaires:
    lights = Luminaires(lamps, 1)
    lights.prepare(type("Geometry", (), {"device": device, "bvh": Still}))
    return lights


def floats(device, values: np.ndarray):
    return device.types.Float(values.astype(np.float32))


def directions(device, lights: Luminaires, light: int, n: int) -> np.ndarray:
    """Directions of n lines, (n, 3): of a Kronecker sequence of two numbers."""
    numbers = [floats(device, np.arange(n) * step % 1 * (1 - 1e-7)) for step in (0.7548776662466927, 0.5698402909980532)]
    _, found = lights.leave(dr.full(device.types.UInt32, light, n), [*numbers, *numbers])
    return np.array(found).T


@pytest.mark.parametrize("name", WEBS)
def test_lines_leave_in_proportion_to_the_web(device, name):
    """Their share in each of 30 x 45 cells of C and gamma (cut at entries of the web), against numeric integration."""
    web, n, fine = WEBS[name], 1 << 18, 16
    plane, gamma = angles(directions(device, prepared(device, luminaire(web)), 0, n))
    edges = np.unique([*np.linspace(web.gamma[0], web.gamma[-1], 45), *web.gamma])
    counts = np.histogram2d(plane, gamma, [np.linspace(0, 360, 31), edges])[0] / n
    middles = ((edges[:-1, None] * (fine - np.arange(fine) - 0.5) + edges[1:, None] * (np.arange(fine) + 0.5)) / fine).ravel()
    ring = np.sin(np.radians(middles)) * np.repeat(np.radians(np.diff(edges)) / fine, fine)
    planes = (np.arange(30 * fine) + 0.5) * 360 / (30 * fine)
    dense = np.stack([intensity(web, np.full(len(middles), c), middles) * ring for c in planes]) * 2 * np.pi / len(planes)
    wanted = dense.reshape(30, fine, -1, fine).sum(axis=(1, 3))
    assert wanted.sum() == pytest.approx(1, abs=2e-4)
    assert np.abs(counts - wanted).max() < 3e-4  # the middle rule is good to 1e-4, n points of the sequence to 1e-4
    assert np.abs(np.cumsum(counts.sum(axis=0)) - np.cumsum(wanted.sum(axis=0))).max() < 2e-4
    assert counts[wanted == 0].sum() == 0


def test_a_wrong_inversion_is_rejected(device, monkeypatch):
    """Directions uniform in gamma within each interval, where the web is wide: what a table of steps would give."""
    monkeypatch.setattr("radiosity.problem.lights.web_tables._inverse", lambda value, coefficients: value)
    monkeypatch.setattr("radiosity.problem.lights.web_tables.WIDEST", np.pi)
    with pytest.raises(AssertionError):
        test_lines_leave_in_proportion_to_the_web(device, "alike")


def test_light_arrives_as_the_web_says(device):
    """The share of the power through a unit area is I / flux / d^2, with every web in one table, turned and moved."""
    lamps = [luminaire(web, (1.0, 2.0, 3.0), TURNED) for web in WEBS.values()]
    lights, random = prepared(device, *lamps), np.random.Generator(np.random.Philox(9))
    ways = random.normal(size=(500, 3))
    point = device.types.Array3f(*(floats(device, x) for x in (lamps[0].position + ways).T))
    distance = np.linalg.norm(ways, axis=1)
    for number, lamp in enumerate(lamps):
        towards, far, share = lights.arrive(dr.full(device.types.UInt32, number, 500), point, [0.5, 0.5])
        plane, gamma = angles((ways / distance[:, None]) @ TURNED.T)
        inside = np.abs(gamma[:, None] - lamp.web.gamma[[0, -1]]).min(axis=1) > 1e-3
        wanted = intensity(lamp.web, plane, gamma) / distance**2
        assert np.allclose(np.array(towards).T, -ways / distance[:, None], atol=1e-5)
        assert np.allclose(np.array(far), distance, rtol=1e-5)
        assert np.allclose(np.array(share)[inside], wanted[inside], rtol=3e-4, atol=1e-4 * wanted.max())


def test_equal_webs_are_one_table(device):
    lights = prepared(device, *(luminaire(replace(WEBS["uneven"])) for _ in range(300)), luminaire(WEBS["beam"]))
    assert len(lights._tables.webs) == 2
    _, gamma = angles(directions(device, lights, 300, 64))
    assert gamma.max() < 1.6


@pytest.mark.parametrize("axes", [np.diag([1.0, -1, -1]), TURNED], ids=["down", "turned"])
def test_black_walls_receive_by_inverse_square_and_cosine(walls, geometry_of, axes):
    lamp = luminaire(WEBS["uneven"], (0.3, 0.45, 0.6), axes, 40.0)
    patches = with_lights(walls, lamp)
    algorithm = run(patches, geometry_of)
    mean, _ = received(algorithm)
    assert mean.sum() == pytest.approx(40, rel=1e-9)
    assert (
        np.abs(mean - expected(patches, lamp, 12)).max() < 0.01
    )  # of 0.19 on average; 0.007 found, and 0.0002 of 64 times the lines
    assert algorithm.tally.books(algorithm.problem, algorithm.capture(), 0)["closes"]


def test_lines_that_leave_in_another_frame_are_rejected(walls, geometry_of, monkeypatch):
    """C turned the other way round: a mirrored web."""
    right = WebTables.draw

    def mirrored(self, head, first, second):
        plane, gamma = right(self, head, first, second)
        return -plane, gamma

    monkeypatch.setattr(WebTables, "draw", mirrored)
    with pytest.raises(AssertionError):
        test_black_walls_receive_by_inverse_square_and_cosine(walls, geometry_of, TURNED)


def test_a_luminaire_let_into_the_ceiling_loses_no_light(walls, geometry_of):
    """It stands in the plane of a face, in whatever place single precision puts that."""
    for height in (1.0, 1.0 + 1e-9, 1.0 - 1e-9):
        lamp = luminaire(WEBS["downwards"], (0.5, 0.37, height), np.diag([1.0, -1, -1]), 40.0)
        patches = with_lights(walls, lamp)
        algorithm = run(patches, geometry_of, 1 << 10)
        book = algorithm.tally.books(algorithm.problem, algorithm.capture(), 0)
        assert book["lost"] == 0
        ceiling = patches.scene.normal[patches.face][:, 2] < -0.5
        assert received(algorithm)[0][ceiling].sum() == 0


@pytest.mark.parametrize("order", ["depth-first", "well-distributed"])
def test_integers_do_not_depend_on_the_order(walls, geometry_of, order):
    lamps = (luminaire(WEBS["uneven"], (0.3, 0.45, 0.6), TURNED, 2.0), luminaire(WEBS["beam"], (0.5, 0.5, 0.5), power=1.0))
    patches = with_lights(walls, *lamps, reflectance=0.6)
    one, other = (run(patches, geometry_of, 1 << 13, order=o).capture().arrays() for o in ("breadth-first", order))
    assert all(np.array_equal(one[key], other[key]) for key in ("arrivals", "fired", "missed"))


def test_a_furnace(walls, geometry_of):
    """Reflectance 1/2 everywhere: all that is sent lands twice over, whatever the webs."""
    patches = with_lights(walls, luminaire(WEBS["uneven"], (0.3, 0.45, 0.6), power=3.0), reflectance=0.5)
    algorithm = run(patches, geometry_of)
    assert received(algorithm)[0].sum() == pytest.approx(6, rel=2e-3)


@pytest.mark.parametrize("disc", [False, True])
def test_light_of_a_soft_luminaire_leaves_its_area(device, disc):
    """Uniformly over the rectangle or ellipse, and it arrives from there."""
    size = np.array([0.6, 0.2, 0.1])
    lamp = luminaire(WEBS["downwards"], (1.0, 2.0, 3.0), TURNED, size=size, soft=True, disc=disc)
    lights, n = prepared(device, lamp), 1 << 12
    numbers = [floats(device, np.arange(n) * step % 1 * (1 - 1e-7)) for step in (0.819, 0.671, 0.549, 0.4503)]
    light = dr.zeros(device.types.UInt32, n)
    origin, _ = lights.leave(light, numbers)
    places = (np.array(origin).T - lamp.position) @ TURNED.T
    target = np.array([0.2, 0.1, 0.3])
    point = device.types.Array3f(*target.tolist())
    towards, far, _ = lights.arrive(light, point, numbers[2:])
    arriving = ((np.array(towards) * np.array(far)).T + target - lamp.position) @ TURNED.T
    moment = size[:2] ** 2 / (16 if disc else 12)
    for found in (places, arriving):
        assert np.abs(found[:, 2]).max() < 1e-5
        assert np.allclose(found.mean(axis=0), 0, atol=3e-3)
        assert np.allclose((found[:, :2] ** 2).mean(axis=0), moment, rtol=0.02)
        inside = ((found[:, :2] / size[:2] * 2) ** 2).sum(axis=1) <= 1 + 1e-5
        assert inside.all() if disc else inside.mean() == pytest.approx(np.pi / 4, abs=0.02)
