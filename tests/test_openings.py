"""Random walks send more lines through openings: the same light with smaller errors, and nothing counted twice."""

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.table import make
from radiosity.problem.lights import through
from radiosity.problem.lights.ball import Ball
from radiosity.problem.lights.opening_lines import OpeningLines
from radiosity.problem.lights.sky import SkyRows
from radiosity.problem.lights.through import SkyThrough, largest_cosine
from radiosity.problem.lights.together import lights_of
from radiosity.problem.model import Problem
from radiosity.problem.source_rows import THROUGH
from radiosity.scene.lights.model import Lights
from radiosity.scene.shapes import box, join, quad
from radiosity.sensors.reflected import mean_reflected, reflected

WINDOW = np.array([[[2, 0, 1], [3, 0, 1], [3, 0, 2], [2, 0, 2]]], float)
TRIANGLES = WINDOW[:, [[0, 1, 2, 2], [0, 2, 3, 3]]][0]
SKY = rd.cie_sky("overcast", 100.0)


def wall(x0: float, x1: float, z0: float, z1: float) -> np.ndarray:
    """A piece of the south wall."""
    return quad((x0, 0, z0), (0, 0, z1 - z0), (x1 - x0, 0, 0))


def room(reflectance: float | np.ndarray = 0.0) -> rd.Scene:
    """A room of 5 x 4 x 3 m with a hole of 1 m² in its south wall, and ground in front of it."""
    around = [wall(0, 2, 0, 3), wall(3, 5, 0, 3), wall(2, 3, 0, 1), wall(2, 3, 2, 3)]
    _, *faces = box((0, 0, 0), (5, 4, 3), inward=True)
    named = zip(("north", "west", "east", "floor", "ceiling"), faces, strict=True)
    parts = [(name, reflectance, 0.0, [face]) for name, face in named]
    ground = [quad((0, -5, 0), (5, 0, 0), (0, 5, 0))]
    return join([*parts, ("south", reflectance, 0.0, around), ("ground", reflectance, 0.0, ground)], source="room")


def walked(
    scene: rd.Scene, openings=None, sky: rd.Sky | None = SKY, suns=(), rays: float = 3e5, size: float = 1.0, **choices
) -> rd.Solution:
    lit = replace(scene, lights=Lights(suns=tuple(suns), sky=sky, openings=openings))
    return rd.solve(rd.subdivide(lit, size=size), "random-walk", rays=rays, seed=5, **choices)


def of(solution: rd.Solution, *names: str) -> np.ndarray:
    """The numbers of the patches of surfaces."""
    scene = solution.patches.scene
    return np.flatnonzero(np.isin(solution.patches.surface, [scene.names.index(name) for name in names]))


INSIDE = ("north", "west", "east", "floor", "ceiling", "south")


def inside(solution: rd.Solution, band: int = 0) -> tuple[float, float]:
    """Power that falls on the inside of the room, and its error; the wall around the window sees no light, and is left out."""
    rows = of(solution, *INSIDE)
    rows = rows[solution.arrivals[rows] > 0]
    mean = float(solution.irradiance[rows, band] @ solution.patches.area[rows])
    error = float(np.sqrt(((solution.irradiance_standard_error[rows, band] * solution.patches.area[rows]) ** 2).sum()))
    return mean, error


def through_window(points: np.ndarray) -> np.ndarray:
    """Irradiance of level points under the overcast sky through the window, by a sum over 200 x 200 parts of it."""
    at = (np.arange(200) + 0.5) / 200
    x, z = (a.ravel() for a in np.meshgrid(2 + at, 1 + at))
    way = np.stack([x, 0 * x, z], axis=1) - points[:, None]
    square = (way**2).sum(axis=2)
    up, out = way[..., 2] / square**0.5, -way[..., 1] / square**0.5
    zenith = 100 * 9 / (7 * np.pi)
    return (zenith * (1 + 2 * up) / 3 * up * out / square).sum(axis=1) / len(x)


def test_a_black_room_receives_what_the_window_lets_in_with_smaller_errors():
    """Floor patches against their exact means; all of the inside against the facade's 3 / 14 + 4 / (7 pi)."""
    without, with_it = walked(room()), walked(room(), WINDOW)
    floor = of(without, "floor")
    (x, y), (v, w) = (np.meshgrid(one, one) for one in np.polynomial.legendre.leggauss(5))
    parts, weights = np.stack([x.ravel(), y.ravel()], axis=1) / 2, (v * w).ravel() / 4
    centre, size = without.patches.centroid[floor], np.sqrt(without.patches.area[floor])
    exact = weights @ [through_window(centre + np.append(p, 0) * size[:, None]) for p in parts]
    for solution in (without, with_it):
        error = solution.irradiance_standard_error[floor, 0]
        assert (np.abs(solution.irradiance[floor, 0] - exact) < 6.7 * error + 1e-3 * exact).all()  # 20 patches: 0.5 % by chance
        assert solution.books[0]["closes"]
    errors = [np.sqrt((solution.irradiance_standard_error[floor, 0] ** 2).mean()) for solution in (without, with_it)]
    assert errors[0] > 5 * errors[1]
    total, error = inside(with_it)
    assert abs(total - 100 * (3 / 14 + 4 / (7 * np.pi))) < 5 * error
    assert error < 0.01 * total


def test_half_of_the_first_lines_go_through_openings():
    lit = replace(room(), lights=Lights(sky=SKY, openings=WINDOW))
    problem = Problem.of(rd.subdivide(lit, cells=1), through=True)
    assert problem.rows.lines is not None
    share = problem.source.share[-2:]
    assert share == pytest.approx([1 - THROUGH, THROUGH])
    assert problem.rows.emission[-1, 0] == pytest.approx(2 * 100 * (3 / 14 + 4 / (7 * np.pi)), rel=0.05)  # from both sides
    assert problem.rows.emission[-1, 0] > 2 * 100 * (3 / 14 + 4 / (7 * np.pi))
    assert Problem.of(rd.subdivide(lit, cells=1)).rows.lines is None


def test_lines_that_cross_several_openings_are_counted_once():
    """All that falls on the inside, and on the ground: an opening named twice, also as triangles, and others across the lines."""
    before, behind = WINDOW + np.array([0, -1.5, 0.2]), WINDOW + np.array([0, 4, 0])  # there may be none in the wall behind
    solution = walked(room(), np.concatenate([WINDOW, WINDOW, TRIANGLES, before, TRIANGLES + np.array([0.3, -0.5, 0]), behind]))
    total, error = inside(solution)
    assert abs(total - 100 * (3 / 14 + 4 / (7 * np.pi))) < 5 * error
    assert error < 0.02 * total
    ground = of(solution, "ground")
    without = walked(room())
    difference = solution.irradiance[ground, 0] - without.irradiance[ground, 0]
    spread = np.hypot(*(one.irradiance_standard_error[ground, 0] for one in (solution, without)))
    assert (np.abs(difference) < 6 * spread).all()


def test_a_sun_through_a_window_brings_its_cosine():
    """800 W/m² on 1 m² of window, seen under the angle of the sun, which is 20 degrees wide."""
    sun = rd.sun(800.0, altitude=40, azimuth=170, diameter=20)  # south is -y
    total, error = inside(walked(room(), WINDOW, sky=None, suns=[sun]))
    assert abs(total + 800 * sun.direction[1]) < 5 * error + 0.003 * total
    assert error < 0.01 * total


@pytest.mark.slow
def test_sky_and_sun_in_two_bands_light_reflecting_walls_alike_with_and_without():
    table = np.zeros((4, 1, 2))
    table[2:, 0] = [[1, 3], [3, 3]]
    sky, sun = rd.Sky("two", table, np.eye(3)), rd.sun([2.0, 1.0], altitude=40, azimuth=170)
    one, other = (walked(room(np.array([0.5, 0.3])), openings, sky, [sun], rays=1e6) for openings in (None, WINDOW))
    for band in (0, 1):
        for name in (*INSIDE, "ground"):
            rows = of(one, name)
            mean = [solution.irradiance[rows, band].mean() for solution in (one, other)]
            error = [np.sqrt((s.irradiance_standard_error[rows, band] ** 2).mean() / len(rows)) for s in (one, other)]
            assert abs(mean[0] - mean[1]) < 7 * np.hypot(*error)


def test_openings_whose_tables_would_be_too_large_share_one(monkeypatch):
    monkeypatch.setattr(through, "ENTRIES", 1000)
    total, error = inside(walked(room(), WINDOW))
    assert abs(total - 100 * (3 / 14 + 4 / (7 * np.pi))) < 5 * error
    assert error < 0.02 * total


def test_tables_of_planes_are_nowhere_below_radiance_times_cosine(random):
    """And in the mean not far above, so that few lines are sent away."""
    sky = rd.Sky("random", random.random((10, 7, 1)), np.roll(np.eye(3), 1, axis=0))
    corners = random.random((3, 4, 3))
    corners[:, 2] = corners[:, 1] + corners[:, 3] - corners[:, 0]
    rows = SkyThrough(SkyRows(sky, 1, Ball(np.zeros(3), 1.0)), OpeningLines(corners, Ball(np.zeros(3), 1.0)))
    way = random.normal(size=(20000, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    normals, which = rows.planes
    assert sorted(which) == [0, 1, 2]
    for plane, normal in enumerate(normals):
        table = rd.Sky("table", rows.tables.values[plane][..., None], sky.axes)
        light = sky.at(way)[:, 0] * np.abs(way @ normal)
        assert (table.at(way)[:, 0] >= light * (1 - 1e-12)).all()
        assert light.mean() > 0.9 * table.at(way)[:, 0].mean()
    assert largest_cosine(8, 4, np.eye(3), np.array([0, 0, 1.0]))[[0, -1]].min() == 1


def test_openings_change_nothing_where_lines_cannot_cross_them_and_other_orders_say_so():
    lit = replace(room(), lights=Lights(sky=SKY, openings=WINDOW))
    assert lights_of(lit, 1) is not None
    with pytest.raises(rd.MethodError, match=r"depth-first.*through openings"):
        rd.solve(rd.subdivide(lit, cells=1), "random-walk", order="depth-first", rays=1000)
    without_far = replace(room(0.5), lights=Lights(openings=WINDOW))
    assert lights_of(without_far, 1, through=True) is None


def test_a_restored_state_goes_on_to_the_same_integers(geometry_of):
    patches = rd.subdivide(replace(room(), lights=Lights(sky=SKY, openings=WINDOW)), cells=2)
    whole, first, again = (make(geometry_of(patches), Problem.of(patches, through=True), rd.Method(), 3, 8) for _ in range(3))
    for quanta in (1 << 10, 1 << 12):
        whole.advance(quanta, lambda lines: None)
    first.advance(1 << 10, lambda lines: None)
    arrays = first.capture().arrays()
    assert {"received", "sent"} <= set(arrays)
    again.restore(again.read(arrays, again.sizes))
    again.advance(1 << 12, lambda lines: None)
    found, wanted = again.capture().arrays(), whole.capture().arrays()
    assert all(np.array_equal(found[name], wanted[name]) for name in ("arrivals", "fired", "received", "sent"))


def test_sensors_read_walks_with_lines_through_openings(geometry_of):
    """The run has rows that the sensors' own problem lacks; the mean of its replicates is the solution."""
    solution = walked(room(0.5), WINDOW, size=2.0, rays=20_000)
    problem = Problem.of(solution.patches)
    found = reflected(solution, geometry_of(solution.patches), problem)
    assert len(found) == solution.replicates
    np.testing.assert_allclose(found.mean(axis=0), mean_reflected(solution, problem), rtol=1e-9, atol=1e-15)
