"""Few lines or none: intervals that are no certain zero, of patches, surfaces and the scene, of all methods.

Arrivals of independent lines are Poisson's, so intervals can be held to draws of a known mean without tracing.
"""

import math
import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import radiosity as rd
from radiosity.scene.shapes import box
from radiosity.solution import intervals

NONE = -math.log(0.025)  # hits that none landed of are not more, with 97.5 %


def squares(*heights, reflectance=0.0, emission=1.0, size=0.02) -> rd.Patches:
    """A lamp of a metre's edge, and small squares above it that look at it."""
    a, c = 0.5 - size / 2, 0.5 + size / 2
    vertices, faces = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)]
    for h in heights:
        faces.append(tuple(range(len(vertices), len(vertices) + 4)))
        vertices += [(a, a, h), (a, c, h), (c, c, h), (c, a, h)]
    n, bands = len(faces), np.shape(emission)
    light = np.zeros((n, *bands))
    light[0] = emission
    names = ["lamp", *(f"sensor {i}" for i in range(n - 1))]
    scene = rd.Scene.from_arrays(vertices, faces, np.full((n, *bands), reflectance), light, surface=np.arange(n), names=names)
    return rd.subdivide(scene, cells=1)


def drawn(patches: rd.Patches, mean: np.ndarray, rng, replicates: int = 8) -> rd.Solution:
    """A solution of black patches whose arrivals are Poisson's, ``mean`` in all."""
    counts = rng.poisson(np.asarray(mean) / replicates, (replicates, len(patches))).astype(float)
    quantum = 1e-3
    values = counts * quantum / patches.area  # of each replicate
    arrivals = counts.sum(axis=0).astype(np.int64)
    error = values.std(axis=0, ddof=1)[:, None] / math.sqrt(replicates)
    error = intervals.least_error(
        values.mean(axis=0)[:, None], error, arrivals, patches.area, np.array([quantum / replicates]), 8
    )
    power = np.stack([counts * quantum, 0 * counts])[..., None]
    emitted = float(patches.emission[:, 0] @ patches.area)
    return rd.Solution(
        patches,
        values.mean(axis=0)[:, None],
        error,
        arrivals,
        10**6,
        1.0,
        round(emitted / quantum),
        replicates,
        (),
        "complete",
        {"choices": {}, "method": "drawn", "seed": 0},
        surface_power=power,
    )


@pytest.mark.parametrize("mean", [0.3, 1.0, 3.0, 10.0, 25.0, 60.0])
def test_intervals_hold_poisson_s_means(mean):
    """At 95 %, two-sided, of patches and surfaces; 1500 draws. A true share of 92 % would pass with a probability of 1 %."""
    patches, rng, held = squares(*[1.0] * 300), np.random.default_rng(round(10 * mean)), []
    truth = mean / 8 * 1e-3 / patches.area[1]
    for _ in range(5):
        solution = drawn(patches, [0, *[mean] * 300], rng)
        for low, high in (solution.interval(0.95, "irradiance"), solution.surface_interval()):
            held.append(((low <= truth) & (high >= truth))[1:].mean())
    assert np.mean(held[::2]) > 0.936
    assert np.mean(held[1::2]) > 0.936


@pytest.mark.parametrize("mean", [0.5, 5.0, 20.0])
def test_the_scene_s_interval_holds_poisson_s_means(mean):
    """200 draws; a true share of 88 % would pass with a probability of 2 %."""
    patches, rng, held = squares(1.0), np.random.default_rng(round(100 * mean)), 0
    truth = mean / 8 * 1e-3 / patches.area.sum()
    for _ in range(200):
        low, high = drawn(patches, [0, mean], rng).scene_interval()
        held += low[0] <= truth <= high[0]
    assert held / 200 > 0.925


def test_no_hit_is_bounded_by_that_of_one_line():
    """-ln(0.025) hits of no clusters; 5.57 of one."""
    area, mean = np.array([2.0, 4.0, 1.0]), np.array([[0.0], [3.0], [1.0]])
    arrivals = np.array([0, 12, 1])
    low, high = intervals.irradiance_bounds(mean, arrivals, area, 0.975)
    one = (12 + 1) / 13
    assert high[0, 0] * area[0] == pytest.approx(NONE * one, rel=1e-12)
    assert high[2, 0] == pytest.approx(5.5716, rel=1e-4)  # Garwood's table, n = 1
    assert low[:, 0] == pytest.approx([0, 6.2006 / 12 * 3, 0.025318], rel=1e-4)  # and n = 12
    _, together = intervals.irradiance_bounds(mean, arrivals, area, 0.975, cluster=4.0)
    assert together[0, 0] == pytest.approx(4 * high[0, 0])


@pytest.fixture(scope="module")
def blind() -> rd.Solution:
    """No line lands: the sensor takes 3e-6 of them."""
    return rd.solve(squares(10.0), "random-walk", quanta=1000)


def test_where_no_line_landed_at_all_the_power_of_one_is_known(blind):
    assert blind.arrivals.sum() == 0
    one = 1.0 / 1000 / 8
    assert blind.irradiance_standard_error[:, 0] == pytest.approx(one / blind.patches.area)
    low, high = blind.interval(0.95, "irradiance")
    assert (low == 0).all()
    assert high[:, 0] == pytest.approx(NONE * one / blind.patches.area)
    assert high[1, 0] > 4e-3 > 3.2e-3  # the truth
    low, high = blind.surface_interval()
    assert high[:, 0] == pytest.approx(NONE * one / blind.patches.area)
    low, high = blind.scene_interval()
    assert high[0] == pytest.approx(NONE * one / blind.patches.area.sum())


@pytest.mark.parametrize("method", [rd.Method(estimator="gathering"), rd.Method(order="matrix")])
def test_where_no_own_line_met_light_one_of_all_replicates_is_known(method):
    """A patch's irradiance is a mean over its own lines: one more that met the lamp would have brought B = 1 over all of them."""
    patches = squares(10.0, 10.0, size=0.5)
    solution = rd.solve(patches, method, quanta=4000, replicates=4)
    state = solution.state
    fired = (
        state["fired"].sum(axis=0)
        if "fired" in state
        else np.bincount(state["keys"].astype(np.int64) >> 32, state["counts"], 4 * len(patches)).reshape(4, -1).sum(axis=0)
    )
    assert fired[0] > 2000
    assert solution.irradiance[0, 0] == 0  # nothing shines upon the lamp
    assert solution.irradiance_standard_error[0, 0] == pytest.approx(1 / fired[0])


def test_reports_of_no_lines_say_unknown(blind):
    assert math.isnan(blind.error)
    assert "unknown: no line hit a patch" in blind.report()
    assert "?: unknown, since no line hit it" in blind.report()
    assert "nan" not in blind.report()
    assert "0.00%" not in blind.report()
    rows = blind.surface_table()
    assert np.isnan([row["error"] for row in rows]).all()
    assert np.isnan([row["interval"] for row in rows]).all()


def test_files_of_older_versions_have_bounds_too(blind):
    """They have an error of zero where nothing landed, and may lack the powers of surfaces."""
    old = replace(blind, irradiance_standard_error=np.zeros((2, 1)), surface_power=None)
    assert old.interval(0.95, "irradiance")[1] == pytest.approx(blind.interval(0.95, "irradiance")[1])
    assert np.isnan(old.surface_interval()).all()
    assert np.isnan(old.scene_interval()).all()
    old.report()


def test_a_surface_that_few_lines_reached_may_get_more():
    """One arrival: the bound of one, 5.57 lines; with reflectance 0.5 half of it as radiosity."""
    patches, rng = squares(1.0, reflectance=0.5), np.random.default_rng(0)
    solution = drawn(patches, [0, 1.2], rng)
    while solution.arrivals[1] != 1:
        solution = drawn(patches, [0, 1.2], rng)
    one = 1e-3 / 8 / patches.area[1]
    low, high = solution.surface_interval()
    assert high[1, 0] == pytest.approx(5.5716 * one, rel=1e-4)
    assert low[1, 0] == 0
    low, high = solution.surface_interval(0.95, "radiosity")
    assert high[1, 0] == pytest.approx(5.5716 * one / 2, rel=1e-4)
    assert high[0, 0] == pytest.approx(1 + NONE * one * patches.area[1] / 2, rel=1e-6)  # the lamp's own light


def test_few_lines_may_all_have_landed_where_it_is_dark():
    """24 lines reached a surface whose patches reflect 0.1 and 0.9: they bound its irradiance from below, its radiosity only by
    the light that it emits."""
    alone, rho = squares(1.0, 1.0).scene, np.array([0, 0.1, 0.9])
    scene = rd.Scene.from_arrays(alone.vertices, alone.faces, rho, alone.emission, surface=[0, 1, 1], names=list("ab"))
    counts = np.tile([0, 2, 1], (8, 1))
    solution = drawn(rd.subdivide(scene, cells=1), np.zeros(3), SimpleNamespace(poisson=lambda mean, shape: counts))
    power = np.add.reduceat(1e-3 * np.stack([counts, counts * rho])[..., None], [0, 1], axis=2)
    solution = replace(solution, surface_power=power)
    assert solution.surface_interval()[0][1, 0] > 0
    low, high = solution.surface_interval(0.95, "radiosity")
    assert low[:, 0].tolist() == [1, 0]
    assert high[1, 0] > power[1, 0, 1, 0] / 8e-4


def test_lines_that_come_in_bunches_bound_surfaces_as_bunches():
    """Of two patches one or the other gets all lines of a replicate: their sum tells of no bunches, they themselves do."""
    alone = squares(1.0, 1.0, 1.0).scene
    scene = rd.Scene.from_arrays(alone.vertices, alone.faces, 0.0, alone.emission, surface=[0, 1, 2, 2], names=list("abc"))
    patches = rd.subdivide(scene, cells=1)
    counts = np.array([[0, 0, 5 * (r % 2), 5 * (1 - r % 2)] for r in range(8)])
    solution = drawn(patches, np.zeros(4), SimpleNamespace(poisson=lambda mean, shape: counts))
    both = np.add.reduceat(solution.surface_power, [0, 1, 2], axis=2)
    solution = replace(solution, surface_power=both)
    bunch = 20 / 7  # (error / mean)^2 of 1 / 7, times 20 arrivals
    one = 1e-3 / 8 / patches.area[1]
    for low, high in (solution.interval(0.95, "irradiance"), solution.surface_interval()):
        assert low[1, 0] == 0
        assert high[1, 0] == pytest.approx(NONE * bunch * one, rel=1e-9)


@pytest.mark.parametrize("replicates", [2, 8])
def test_rare_lines_of_another_colour_have_their_own_power(replicates):
    """Of the power a hundredth is red, along its own lines: where none landed, one would have brought a whole quantum of it. Many
    blue ones say nothing of that."""
    vertices, faces = [], []
    for x in (0.0, 3.0):
        for h, turned in ((0.0, False), (0.02 if x else 1.0, True)):
            corners = [(x, 0, h), (x + 1, 0, h), (x + 1, 1, h), (x, 1, h)]
            faces.append(tuple(range(len(vertices), len(vertices) + 4)))
            vertices += corners[::-1] if turned else corners
    emission = np.array([[0.01, 0.0], [0, 0], [0, 1.0], [0, 0]])  # a dim red lamp far below a plate, a blue one close to its own
    scene = rd.Scene.from_arrays(
        vertices, faces, np.full((4, 2), 0.0), emission, surface=np.arange(4), names=list("abcd"), bands=("red", "blue")
    )
    solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", quanta=40, replicates=replicates)
    assert solution.arrivals[3] > intervals.FEW
    quantum = 1.01 / 40 / replicates
    here = (solution.arrivals == 0) | (solution.irradiance[:, 0] == 0)
    assert here[3]
    _, high = solution.interval(0.95, "irradiance")
    assert (high[here, 0] >= NONE * quantum * 0.999).all()
    assert (solution.irradiance_standard_error[here, 0] >= quantum * 0.999).all()


METHODS = {
    "firing": {"method": "random-walk"},
    "walks": {"method": "particle-tracing"},
    "gathering": {"method": "particle-tracing", "estimator": "gathering"},
    "incremental": {"method": "stochastic-jacobi"},
    "regular": {"method": "stochastic-ray"},
    "control variate": {"method": "stochastic-jacobi", "control_variate": True},
    "matrix": {"method": "random-walk", "order": "matrix"},
    "form factors": {"method": "global-form-factors"},
    "multipath": {"method": "global-multipath"},
    "pooling": {"method": "transillumination"},
    "density": {"method": "density-estimation"},
}


ESCAPES = [
    rd.Method(),
    rd.Method(absorption="drawn"),
    rd.Method(absorption="fractional"),
    rd.Method(equation="continuous"),
    *(rd.Method(estimator=name) for name in ("absorption", "survival", "gathering")),
    *(rd.Method(order=name) for name in ("incremental", "regular", "matrix")),
]


@pytest.mark.parametrize("method", ESCAPES, ids=str)
def test_lines_that_escape_are_lines(method):
    """A single triangle sends one for each quantum, and none comes back."""
    scene = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.5, 1.0)
    solution = rd.solve(rd.subdivide(scene, cells=1), method, quanta=1000, replicates=2)
    assert solution.rays == 2000
    assert solution.escaped[0] == solution.books[0]["emitted"] == 0.5


@pytest.mark.parametrize("name", METHODS)
def test_every_method_leaves_room_above_zero(name):
    """A dim corner of a scene at a few lines a patch: wherever the result is zero, the truth is not, and the interval says so."""
    patches = rd.subdivide(rd.load_scene("room"), cells=4)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        solution = rd.solve(patches, rays=2_000, **METHODS[name])
    none = solution.irradiance[:, 0] == 0
    assert none.any() or name in ("control variate", "matrix", "form factors", "pooling")
    low, high = solution.interval(0.95, "irradiance")
    assert (solution.irradiance_standard_error[none] > 0).all()
    assert (high[none] > 0).all()
    assert (low[none] == 0).all()
    assert np.isfinite(high).all()
    for low, high in (solution.surface_interval(), solution.scene_interval()):
        assert (high > 0).all()
        assert (high > low).all()


def test_a_control_variate_leaves_room_on_both_sides():
    """In a furnace B = 1; few lines land on most patches."""
    patches, held = rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=3), []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        for seed in range(6):
            solution = rd.solve(patches, "stochastic-jacobi", control_variate=True, rays=8_000, seed=seed)
            low, high = solution.interval(0.95, "irradiance")
            held.append((low <= 1) & (high >= 1))
    assert np.mean(held) > 0.92


def test_a_start_that_uses_up_the_lines_is_no_result():
    """Regular iterations leave their start out of the mean: a first stage that it used up needs one iteration more."""
    patches = rd.subdivide(rd.load_scene("labyrinth-0.9"), cells=1)
    for control in (False, True):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rd.RadiosityWarning)
            solution = rd.solve(patches, "stochastic-ray", control_variate=control, rays=1_000)
        assert solution.arrivals.sum() > 500
        low, high = solution.scene_interval(0.9999)
        assert low[0] <= 1 <= high[0]
        assert solution.error < 2


@pytest.fixture(scope="module")
def closed() -> tuple[rd.Patches, float]:
    """A black room 2 x 2 x 1 m with a lit floor, the sensor of 5 cm in its ceiling last; and the sensor's irradiance."""
    a, b = 0.5, 0.55
    walls = box((0, 0, 0), (2, 2, 1), inward=True)
    walls = [corners for corners in walls if not (corners[:, 2] == 1).all()]
    top = [(0, a, 0, 2), (b, 2, 0, 2), (a, b, 0, a), (a, b, b, 2), (a, b, a, b)]
    walls += [np.array([(x, y, 1), (x, v, 1), (u, v, 1), (u, y, 1)], float) for x, u, y, v in top]
    emission = [float((corners[:, 2] == 0).all()) for corners in walls]
    faces = np.arange(4 * len(walls)).reshape(-1, 4)
    scene = rd.Scene.from_arrays(np.concatenate(walls), faces, 0.0, emission, surface=np.arange(len(walls)))
    x, y = np.meshgrid(*2 * [(np.arange(400) + 0.5) / 200])
    return rd.subdivide(scene, cells=1), 4 * float((1 / (math.pi * ((x - 0.525) ** 2 + (y - 0.525) ** 2 + 1) ** 2)).mean())


def held(closed, quanta: int, runs: int) -> np.ndarray:
    """Shares of runs in which the intervals of the sensor, as a patch and as a surface, hold the truth."""
    (patches, truth), found = closed, []
    for seed in range(runs):
        solution = rd.solve(patches, "random-walk", quanta=quanta, seed=seed)
        found.append(
            [
                low[-1, 0] <= truth <= high[-1, 0]
                for low, high in (solution.interval(0.95, "irradiance"), solution.surface_interval())
            ]
        )
    return np.mean(found, axis=0)


def test_a_sensor_that_half_a_line_reaches(closed):
    """At 92 %, 40 runs would hold 33 or fewer with a probability of 3 %. In more than half of them no line lands."""
    assert (held(closed, 218, 40) > 33 / 40).all()


@pytest.mark.slow
@pytest.mark.parametrize("quanta", [218, 2_000, 8_000, 30_000])
def test_a_sensor_that_few_lines_reach(closed, quanta):
    """0.5, 4.6, 18 and 69 lines in the mean."""
    assert (held(closed, quanta, 400) >= 0.92).all()


def test_a_report_without_a_complete_stage_has_no_nan(blind):
    from radiosity.solution.without_results import without_results

    text = without_results(blind.patches, 8, 1.0, "interrupted", blind.provenance, {}).report()
    assert "nan" not in text
    assert "emitted ? W" in text
    assert "?: unknown, since no stage is complete yet" in text
