"""Array-RQMC: the order of particles, which of them go on, and what both are for."""

import numpy as np
import pytest
from methods import critical

import radiosity as rd
from radiosity.algorithms.walks import shooting, sorting
from radiosity.device.backend import choose, upload
from radiosity.lab import cases, slopes
from radiosity.lab.measure import measure
from radiosity.lab.study import Arm, Protocol
from radiosity.tracing.geometry import Geometry

TYPES = choose("cpu").types
PLAIN, SORTED = (rd.Method(equation="continuous", order=order, randomisation="shared") for order in ("breadth-first", "sorted"))


def error(method, quanta=1 << 15):
    """Return the stated error of a furnace of 70 patches, whose true value is 1, and its largest deviation in such errors."""
    patches = cases.maze("labyrinth-0.5").patches
    solution = rd.solve(patches, method, quanta=quanta, replicates=8)
    stated = solution.standard_error[:, 0]
    return np.sqrt(patches.area @ stated**2 / patches.area.sum()), np.abs((solution.radiosity[:, 0] - 1) / stated).max()


def words(values):
    return upload(TYPES.UInt32, np.asarray(values, np.uint32))


def test_the_curve_visits_each_cell_once_and_steps_to_neighbours():
    y, x = np.mgrid[:32, :32].reshape(2, -1)
    number = np.array(sorting.curve(words(x), words(y), 5))
    assert np.array_equal(np.sort(number), np.arange(1024))
    at = np.argsort(number)
    assert np.array_equal(np.abs(np.diff(x[at])) + np.abs(np.diff(y[at])), np.ones(1023))


def test_of_any_stretch_as_many_go_on_as_the_chances_say():
    chances = np.random.default_rng(1).random(10_000).astype(np.float32)
    chances[::7] = 0
    for part in (0, 1 << 31, 0xFFFFFFFF, 12345):
        number = np.array(sorting.cuts(TYPES, upload(TYPES.Float, chances), words([part, part])[0]))
        after = np.cumsum(number < chances)
        assert np.abs(after - np.cumsum(chances, dtype=np.float64)).max() < 1.01


def test_over_all_places_of_the_cuts_each_goes_on_with_its_chance():
    chances, count = np.array([0.25, 0.5, 0.125, 0.875, 1, 0], np.float32), 64
    numbers = [np.array(sorting.cuts(TYPES, upload(TYPES.Float, chances), words([k << 26] * 2)[0])) for k in range(count)]
    assert np.array_equal(np.mean(numbers < chances, axis=0), chances)


def test_particles_stand_by_face_and_those_that_hit_nothing_last():
    geometry = Geometry(rd.subdivide(rd.load_scene("room"), cells=3), choose("cpu"))
    geometry.prepare()
    drawn, n = np.random.default_rng(2), 5_000
    face, on = drawn.integers(0, geometry.patches.scene.n_faces, n), drawn.random(n) < 0.9
    s, t = (3 * drawn.random((2, n))).astype(np.float32)
    place = words(face), upload(TYPES.Float, s), upload(TYPES.Float, t)
    rows = np.array(sorting.order(geometry, place, upload(TYPES.Bool, on), n))
    assert np.array_equal(np.sort(rows), np.arange(n))
    assert on[rows[: on.sum()]].all()
    rows = rows[: on.sum()]
    assert (np.diff(face[rows]) >= 0).all()
    same = np.diff(face[rows]) == 0
    assert np.hypot(np.diff(s[rows]), np.diff(t[rows]))[same].mean() < 0.25  # 1.56 in no order


def test_the_furnace_is_met_within_errors_that_are_smaller():
    (plain, _), (own, off) = error(PLAIN), error(SORTED)
    assert off < critical(8, 70)
    assert own < 0.8 * plain  # 0.62 to 0.66 by three seeds


def test_particles_in_no_order_lose_the_gain(monkeypatch):
    def shuffled(geometry, place, on, size):
        rows = np.array(ordered(geometry, place, on, size))
        count = int(np.array(on).sum())
        rows[:count] = np.random.default_rng(size).permutation(rows[:count])
        return words(rows)

    ordered, own = sorting.order, error(SORTED)[0]
    monkeypatch.setattr(shooting, "order", shuffled)
    assert own < 0.8 * error(SORTED)[0]


def test_a_threshold_in_place_of_cuts_is_rejected(monkeypatch):
    monkeypatch.setattr(shooting, "cuts", lambda types, chances, part: 0.5 + 0 * chances)
    assert error(SORTED)[1] > critical(8, 70)


def test_parts_of_replicates_are_those_of_the_whole():
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    whole = rd.solve(patches, SORTED, quanta=3_000, replicates=3)
    part = rd.solve(patches, SORTED, quanta=3_000, replicates=1, first_replicate=2)
    assert np.array_equal(whole.state["received"][2], part.state["received"][0])


@pytest.mark.slow
def test_it_agrees_with_plain_walks_on_an_open_scene_in_colours():
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=3)
    one, two = (rd.solve(patches, method, rays=4e6, replicates=16, seed=2) for method in (PLAIN, SORTED))
    off = np.abs(one.irradiance - two.irradiance) / np.hypot(one.irradiance_standard_error, two.irradiance_standard_error)
    assert np.nanmax(off) < critical(16, off.size)


@pytest.mark.slow
@pytest.mark.parametrize("scene", cases.MAZES)
def test_it_converges_faster_than_plain_walks(scene):
    case, slope = cases.maze(scene), {}
    for method in (SORTED, PLAIN):
        series = measure(Arm("", method, ""), case, cases.ones(case), Protocol(last=20, replicates=8))
        slope[method] = slopes.fit(series.lines, series.area_weighted).value
    assert slope[SORTED] < -0.6 < slope[PLAIN]
