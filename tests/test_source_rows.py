"""Lights without area are rows that fire and never receive: shown by the point light of docs/skeletons."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import drjit as dr
import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.base import AbstractAlgorithm
from radiosity.algorithms.table import make
from radiosity.problem.model import Problem
from radiosity.scene.shapes import box, join
from radiosity.solution.errors import mean_and_error

FILE = Path(__file__).parents[1] / "docs" / "skeletons" / "point_light.py"
QUANTA, REPLICATES = 1 << 16, 8
MIDDLE = np.array([[0.3, 0.45, 0.6]])


@pytest.fixture(scope="module")
def skeleton():
    spec = spec_from_file_location("point_light", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def room(reflectance, emission=0.0, cells: int = 4) -> rd.Patches:
    """A closed unit cube."""
    return rd.subdivide(
        join([("walls", reflectance, emission, box((0, 0, 0), (1, 1, 1), inward=True))], source="room"), cells=cells
    )


def solid_angle(corners: np.ndarray, point: np.ndarray) -> float:
    """Of a rectangle with these corners, sr (van Oosterom and Strackee 1983, for its two triangles)."""
    a, b, c, d = (corner - point for corner in corners)
    return sum(
        2 * np.arctan2(abs(np.dot(one, np.cross(two, three))), denominator(one, two, three))
        for one, two, three in ((a, b, c), (a, c, d))
    )


def denominator(one, two, three) -> float:
    lengths = [np.linalg.norm(x) for x in (one, two, three)]
    return float(np.prod(lengths) + one @ two * lengths[2] + two @ three * lengths[0] + three @ one * lengths[1])


def run(skeleton, patches, power, position=MIDDLE, geometry_of=None, quanta=QUANTA, **choices) -> AbstractAlgorithm:
    lights = skeleton.PointLights(position, np.atleast_2d(power))
    assert geometry_of is not None
    algorithm = make(geometry_of(patches), Problem.of(patches, lights), rd.Method(**choices), 3, REPLICATES)
    algorithm.advance(quanta, lambda lines: None)
    return algorithm


def received(algorithm, group: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """W of each patch and their standard errors."""
    values, unit = algorithm.tally.irradiance(algorithm.problem, algorithm.capture(), group)
    mean, error = mean_and_error(values)
    return mean * unit, error * unit


def expected(patches, power: float, position=MIDDLE[0]) -> np.ndarray:
    """W that patches of black walls receive: power times solid angle over 4 pi."""
    return power * np.array([solid_angle(corners, position) for corners in patch_corners(patches)]) / (4 * np.pi)


def patch_corners(patches) -> np.ndarray:
    """(n_patches, 4, 3) m."""
    scene, result = patches.scene, []
    for i in range(len(patches)):
        face = patches.face[i]
        origin, first, fourth = (scene.vertices[scene.faces[face, k]] for k in (0, 1, 3))
        column, row, _ = (x[0] for x in patches.places(slice(i, i + 1)))
        u, v = (first - origin) / patches.columns[face], (fourth - origin) / patches.rows[face]
        corner = origin + column * u + row * v
        result.append([corner, corner + u, corner + u + v, corner + v])
    return np.array(result)


def test_black_walls_receive_by_solid_angle(skeleton, geometry_of):
    patches = room(0.0)
    algorithm = run(skeleton, patches, 40.0, geometry_of=geometry_of)
    mean, error = received(algorithm)
    wanted = expected(patches, 40.0)
    assert wanted.sum() == pytest.approx(40)
    assert mean.sum() == pytest.approx(40, rel=1e-12)
    assert (np.abs(mean - wanted) < 5.5 * error + 1e-4).all()  # of Student's t with 7 degrees, 96 patches: 9 % by chance
    assert np.abs(mean / wanted - 1).max() < 0.02


def test_a_wrong_light_is_rejected(skeleton, geometry_of, monkeypatch):
    """Azimuth and height uniform as angles, which sends too much to the poles."""

    def leave(self, light, numbers):
        origin = dr.gather(self._point, self._places, light)
        angle = np.pi * numbers[1]
        sine, cosine = dr.sincos(angle)
        x, y = skeleton.turn(numbers[0])
        return origin, type(origin)(x * sine, y * sine, cosine)

    monkeypatch.setattr(skeleton.PointLights, "leave", leave)
    patches = room(0.0)
    mean, _ = received(run(skeleton, patches, 40.0, geometry_of=geometry_of))
    assert np.abs(mean / expected(patches, 40.0) - 1).max() > 0.2


def test_a_furnace_of_walls_and_lights(skeleton, geometry_of):
    """Reflectance 1/2 everywhere: all that is sent lands twice over, wherever the lights are; and the books close."""
    patches = room(0.5, 0.1)
    algorithm = run(skeleton, patches, np.array([[3.0], [1.5]]), np.array([[0.2, 0.3, 0.4], [0.7, 0.7, 0.9]]), geometry_of)
    mean, _ = received(algorithm)
    assert mean.sum() == pytest.approx(2 * (3 + 1.5 + 0.6), rel=2e-3)
    book = algorithm.tally.books(algorithm.problem, algorithm.capture(), 0)
    assert book["closes"]
    assert book["emitted"] == pytest.approx(3 + 1.5 + 0.6, rel=1e-5)
    assert book["absorbed"] == pytest.approx(3 + 1.5 + 0.6, rel=2e-3)


def test_rows_of_lights_receive_nothing(skeleton, geometry_of):
    state = run(skeleton, room(0.5), np.array([[3.0], [1.5]]), MIDDLE.repeat(2, axis=0), geometry_of).capture()
    assert state.arrivals.shape == (REPLICATES, 98)
    assert (state.arrivals[:, 96:] == 0).all()
    assert (state.fired[:, 96:] > 0).all()
    assert state.fired.sum() == state.arrivals.sum() + state.missed.sum()


@pytest.mark.parametrize("order", ["depth-first", "well-distributed"])
def test_integers_do_not_depend_on_the_order(skeleton, geometry_of, order):
    one, other = (run(skeleton, room(0.7), 2.0, geometry_of=geometry_of, order=o).capture() for o in ("breadth-first", order))
    assert all(np.array_equal(one.arrays()[key], other.arrays()[key]) for key in ("arrivals", "fired", "missed"))


def test_stages_and_a_restored_state_end_in_the_same_integers(skeleton, geometry_of):
    algorithm = run(skeleton, room(0.7), 2.0, geometry_of=geometry_of, quanta=1 << 12)
    state = algorithm.capture()
    again = run(skeleton, room(0.7), 2.0, geometry_of=geometry_of, quanta=1)
    again.restore(state)
    again.advance(QUANTA, lambda lines: None)
    whole = run(skeleton, room(0.7), 2.0, geometry_of=geometry_of).capture()
    found = again.capture().arrays()
    assert all(np.array_equal(found[key], whole.arrays()[key]) for key in ("arrivals", "fired", "missed"))


def test_bands_of_lights_and_walls(skeleton, geometry_of):
    """Each band is a furnace of its own; a light's colour differs from that of the walls' emission."""
    reflectance, emission, power = np.array([0.5, 0.2]), np.array([0.1, 0.4]), np.array([[2.0, 1.0]])
    algorithm = run(skeleton, room(reflectance, emission), power, geometry_of=geometry_of)
    assert algorithm.problem.groups.n_groups == 2
    for band in (0, 1):
        mean, _ = received(algorithm, band)
        assert mean.sum() == pytest.approx((power[0, band] + 6 * emission[band]) / (1 - reflectance[band]), rel=5e-3)
        assert algorithm.tally.books(algorithm.problem, algorithm.capture(), band)["closes"]


def test_proportional_bands_are_one_group_only_with_proportional_lights(skeleton):
    patches = room(0.5, np.array([0.1, 0.2]))
    for power, groups in (([[1.0, 2.0]], 1), ([[1.0, 1.0]], 2)):
        assert Problem.of(patches, skeleton.PointLights(MIDDLE, np.array(power))).groups.n_groups == groups


def test_algorithms_that_know_no_lights_refuse_them(skeleton, geometry_of):
    patches = room(0.5)
    problem = Problem.of(patches, skeleton.PointLights(MIDDLE, np.array([[1.0]])))
    for method in ("particle-tracing", "stochastic-jacobi", "global-multipath", "full-matrix"):
        with pytest.raises(rd.MethodError, match="lights without area"):
            make(geometry_of(patches), problem, (rd.PRESETS | rd.BASELINES)[method].method, 0, 1)
