"""Importance for luminaires, suns and skies: closed forms, no bias whatever it is, and less variance where it is wanted.

Statistical tests take alpha = 1e-3, shared out among surfaces (Bonferroni); seeds are fixed.
"""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import cube, cube_irradiance
from scipy.stats import t as student
from test_gather_lights import OVERCAST, WINDOW, lamp, lit, room_with_window
from test_source_rows import solid_angle

import radiosity as rd
from radiosity.algorithms.importance.adjoint import Importance
from radiosity.algorithms.importance.sources import LEAST, FirstHits
from radiosity.algorithms.iterations.exchange import Exchange
from radiosity.device.backend import choose
from radiosity.problem.model import Problem
from radiosity.run.aim import Aim
from radiosity.run.budget import first_rung
from radiosity.sampling.streams import Seed
from radiosity.scene.lights.model import Lights
from radiosity.scene.lights.sky import Sky
from radiosity.scene.lights.sun import Sun
from radiosity.scene.shapes import box
from radiosity.tracing.geometry import Geometry

METHOD = rd.Method(order="incremental", numbers="random")
REFLECTANCE = np.array([0.9, 0.1, 0.8, 0.2, 0.7, 0.3])
PLACES, WATTS = np.array([[0.3, 0.45, 0.6], [0.7, 0.6, 0.2]]), (1.0, 3.0)
RUNS, ALPHA = 256, 1e-3
SUN = Sun("sun", np.array([-0.8, 0.0, 0.6]), np.array([5.0]))
SOME = np.array([1.0, 1.1, 0.9, 1.0, 0.8, 1.2, 1.0, 1.3])
SHARES = np.array([1.0, 30.0, 0.01, 3.0, 0.2, 100.0, 0.05, 40.0])  # of six walls and two lamps


def direct(places: np.ndarray, watts) -> np.ndarray:
    """(6,) W/m² that point lamps bring to the walls of a unit cube: by solid angles."""
    walls = box((0, 0, 0), (1, 1, 1), inward=True)
    angles = [[solid_angle(np.asarray(wall), at) for wall in walls] for at in places]
    return np.array(watts) @ np.array(angles) / (4 * np.pi)


def exact(first: np.ndarray) -> np.ndarray:
    """(6,) irradiance of the walls of the cube, from that by lamps."""
    return first + cube_irradiance(REFLECTANCE, REFLECTANCE * first)


def received(solution: rd.Solution) -> np.ndarray:
    """(replicates, n_surfaces) W."""
    return solution.surface_power[0][:, :, 0]


@pytest.fixture(scope="module")
def lamps():
    """A cube whose walls are one patch each, with two lamps, and its exact irradiance."""
    return lit(cube(REFLECTANCE[:, None], 0.0), *(lamp(p, power=w) for p, w in zip(PLACES, WATTS, strict=True))), exact(
        direct(PLACES, WATTS)
    )


def largest_t(lamps, monkeypatch, values: np.ndarray, quanta: int) -> tuple[float, float]:
    """The largest t of all walls, and the bound that it exceeds with probability ALPHA if there is no bias."""
    patches, irradiance = lamps
    monkeypatch.setattr("radiosity.run.aim.Aim.shared", lambda *_: Importance(values, 0.0, 0.0, 0))
    power = received(rd.solve(patches, METHOD, quanta=quanta, replicates=RUNS, seed=3, importance="surface:wall 3"))
    t = (power.mean(axis=0) - irradiance) / (power.std(axis=0, ddof=1) / RUNS**0.5)
    return float(np.abs(t).max()), float(student.ppf(1 - ALPHA / 2 / 6, RUNS - 1))


def test_no_importance_of_lamps_has_a_bias(lamps, monkeypatch):
    """Also one that is wrong: a lamp whose lines carry twenty quanta, and one with lines of a fortieth."""
    largest, bound = largest_t(lamps, monkeypatch, SHARES, 20)
    assert largest < bound


def test_lines_of_lamps_that_are_not_weighted_are_rejected(lamps, monkeypatch):
    """Each line of a lamp carries a quantum, however many it fires: the same test sees it."""
    send = Exchange.send

    def unweighted(self, power, expected, *more):
        factor = np.ones((self.replicates, self.n, 1))
        factor[:, 6:] = (SOME[6:] / SOME[6])[:, None]
        return send(self, power * type(power)(factor.ravel()), expected, *more)

    monkeypatch.setattr(Exchange, "send", unweighted)
    largest, bound = largest_t(lamps, monkeypatch, SOME, 160)
    assert largest > 2 * bound


def test_a_lamp_is_worth_the_mean_square_of_what_its_lines_hit(geometry_of):
    """In the middle of a cube a sixth of its lines hits each wall."""
    patches = lit(cube(0.5, 0.0), lamp((0.5, 0.5, 0.5), power=4.0))
    problem = Problem.of(patches).scalar
    found = FirstHits.of(geometry_of(patches), problem, METHOD, Seed(1))
    worth = np.array([0.0, 3.0, 0.0, 0.0, 0.0, 0.0])
    mean, root = found.means(worth)
    assert found.power.tolist() == [4.0]
    assert mean[0] == pytest.approx(3 / 6, rel=0.062)  # five standard errors of 32 768 lines
    assert root[0] == pytest.approx(3 / 6**0.5, rel=0.031)


@pytest.fixture(scope="module")
def rooms():
    """Five rooms in a row, whose own lamp is dark; a strong luminaire hangs in the first, a weak one near the desk."""
    scene = rd.load_scene("rooms")
    lamps = lamp((2, 1.5, 2), power=99.0), lamp((17.5, 1.5, 2), power=1.0)
    scene = replace(scene, emission=0 * scene.emission, lights=Lights(lamps))
    return rd.subdivide(scene, size=1.0)


def test_importance_takes_lines_from_a_lamp_that_adds_nothing(rooms):
    """The far lamp has a hundredth of the lines that its power asks for, and not none. Both ends tell the same result."""
    problem = Problem.of(rooms)
    geometry = Geometry(problem.patches, choose("cpu"))
    geometry.prepare()
    found = Aim.of("surface:desk", geometry, problem.patches).shared(problem, geometry, METHOD, 1)
    assert len(found.values) == len(rooms) + 2
    assert found.values[-2] == LEAST
    assert found.values[-1] == pytest.approx(100, rel=0.05)  # the mean over 100 W is 1
    assert found.light == pytest.approx(found.adjoint, rel=0.11)


def test_means_are_equal_and_the_variance_is_less(rooms):
    """With as many quanta; without importance a hundredth of the lines leaves the lamp that matters."""
    options = {"quanta": 4096, "replicates": 64, "seed": 5}
    plain = rd.solve(rooms, METHOD, **options)
    aimed = rd.solve(rooms, METHOD, **options, importance="surface:desk")
    desk = rooms.scene.names.index("desk")
    for solution in (plain, aimed):
        assert solution.books[0]["closes"]
        assert solution.books[0]["emitted"] == pytest.approx(100)
    one, other = (received(solution)[:, desk] for solution in (plain, aimed))
    t = (one.mean() - other.mean()) / np.hypot(one.std(ddof=1) / 8, other.std(ddof=1) / 8)
    assert abs(t) < student.ppf(1 - ALPHA / 2, 63)
    assert other.var(ddof=1) < one.var(ddof=1) / 20


@pytest.mark.slow
def test_suns_and_skies_send_the_light_that_random_walks_find():
    """Through a window that is an opening: lines through it are rows of their own, which importance gives nearly all lines."""
    scene = room_with_window()
    scene = replace(scene, surface=np.arange(scene.n_faces), names=tuple(f"wall {i}" for i in range(scene.n_faces)))
    patches = lit(scene, suns=(SUN,), sky=Sky("sky", OVERCAST, np.eye(3)), openings=WINDOW, cells=2)
    walk = rd.solve(patches, "random-walk", rays=200_000, replicates=16, seed=1)
    aimed = rd.solve(patches, METHOD, rays=1_000_000, replicates=16, seed=2, importance="surface:wall 1")
    one, other = received(walk), received(aimed)
    lit_at = one.any(axis=0)
    errors = [x.std(axis=0, ddof=1) / len(x) ** 0.5 for x in (one, other)]
    t = (one.mean(axis=0) - other.mean(axis=0))[lit_at] / np.hypot(*errors)[lit_at]
    assert np.abs(t).max() < student.ppf(1 - ALPHA / 2 / len(t), 15)


def test_a_run_with_lamps_goes_on_to_the_same_bits(lamps, tmp_path):
    """From a file: the importance of lamps is a part of the state."""
    patches, _ = lamps
    given = {"replicates": 2, "seed": 4, "importance": "surface:wall 3"}
    rung = first_rung("incremental", 2, Problem.of(patches).source.share)
    rd.solve(patches, METHOD, quanta=rung, **given).save(tmp_path / "short.npz")
    longer = rd.solve(patches, METHOD, quanta=2 * rung, resume=rd.load_solution(tmp_path / "short.npz"), **given)
    whole = rd.solve(patches, METHOD, quanta=2 * rung, **given)
    assert (longer.irradiance == whole.irradiance).all()
    assert longer.rays == whole.rays


OTHERS = [{"estimator": "bidirectional"}, {"control_variate": True}, {"basis": "linear"}, {"order": "regular"}]


@pytest.mark.parametrize("choice", OTHERS, ids=str)
def test_iterations_that_take_no_lights_say_so(lamps, choice):
    with pytest.raises(rd.MethodError, match="lights without area: 'lamp'"):
        rd.solve(lamps[0], rd.Method(**{"order": "incremental"} | choice), rays=1000)
