"""Iterations of local lines against closed forms and the firing engine.

Bounds are in standard errors of 16 replicates. About 150 surfaces are compared; 6 combined standard errors (Student with about 25
degrees of freedom: p = 3e-6) leave a chance of less than 1e-3 for a false alarm, and seeds are fixed.
"""

import numpy as np
import pytest
from enclosures import cube
from iterations import VARIANTS, walked
from replicates import difference, powers

import radiosity as rd
from radiosity.algorithms.iterations.control import SHARE, median, source_constant
from radiosity.run import budget

SIGMAS = 6.0
SLOW = pytest.mark.slow
LONGER = ("incremental", "regular, warm-up", "regular, both ends", "regular, control variate")  # others have each choice, too
COLORS = [[0.8, 0.5, 0.1], [0.2, 0.5, 0.7], [0.6, 0.3, 0.3], [0.1, 0.7, 0.2], [0.5, 0.5, 0.6], [0.3, 0.3, 0.75]]
LIGHT = [[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [0.0, 0.0, 0.0], [0.0, 0.2, 0.9], [0.0, 0.0, 0.0]]


@pytest.mark.parametrize("mean_reflectance", [pytest.param(0.1, marks=SLOW), pytest.param(0.5, marks=SLOW), 0.9])
@pytest.mark.parametrize("name", VARIANTS)
def test_labyrinth_furnace_is_one_everywhere(name, mean_reflectance):
    patches = rd.subdivide(rd.load_scene(f"labyrinth-{mean_reflectance}"), cells=1)
    settled = "control" in name or "everything" in name
    rays = 1_000_000 if settled else 500_000
    solution = rd.solve(patches, rd.Method(**VARIANTS[name]), rays=rays, replicates=16)
    error = solution.radiosity - 1
    if settled:
        # the constant is the solution: what lines carry goes to zero, and with it any measure of the error; a start-up leaves
        # at most its share of the light, see iteration_plan.DARK
        assert np.abs(error).max() < 1e-3
    else:
        z = error / solution.standard_error
        assert np.abs(z).max() < 6.5  # the largest of 70, Student with 15 degrees of freedom: p = 70 * 1e-5
        assert 0.75 < np.sqrt(np.mean(z**2)) < 1.5
    assert abs(solution.rays / rays - 1) < 0.05
    assert solution.escaped[0] == 0
    assert solution.books[0]["lost"] == 0


@pytest.mark.parametrize("scene", ["room", "open", "two-sided"])
@pytest.mark.parametrize("name", VARIANTS)
def test_surfaces_receive_what_the_firing_engine_says(reference, name, scene):
    patches, expected = reference[scene]
    solution = rd.solve(patches, rd.Method(**VARIANTS[name]), rays=500_000, replicates=16, seed=3)
    assert np.abs(difference(powers(solution), expected)).max() < SIGMAS
    book = solution.books[0]
    assert abs(book["rounding"]) < 0.02 * book["emitted"]
    assert book["closes"] is (True if name == "incremental" else None)
    if scene != "room":
        assert book["escaped"] > 0.02 * book["emitted"]


@pytest.fixture(scope="module")
def reference():
    return walked()


@pytest.mark.parametrize("name", [pytest.param(name, marks=SLOW) if name in LONGER else name for name in VARIANTS])
def test_each_band_is_its_own_problem(name):
    """Alpha as in `test_bands`: 96 patches, Student with about 30 degrees of freedom."""
    method = rd.Method(**VARIANTS[name])
    together = rd.solve(rd.subdivide(cube(COLORS, LIGHT), cells=4), method, rays=300_000, replicates=16)
    for band in range(3):
        scene = cube(np.array(COLORS)[:, band], np.array(LIGHT)[:, band])
        single = rd.solve(rd.subdivide(scene, cells=4), method, rays=300_000, replicates=16, seed=9)
        error = np.hypot(together.irradiance_standard_error[:, band], single.irradiance_standard_error[:, 0])
        z = (together.irradiance[:, band] - single.irradiance[:, 0]) / error
        assert np.abs(z).max() < 6.5
        assert 0.7 < np.sqrt(np.mean(z**2)) < 1.4


def test_both_ends_and_a_control_variate_lessen_the_error():
    patches = rd.subdivide(rd.load_scene("room"), cells=6)

    def error(**choices):
        return rd.solve(patches, rd.Method(**choices), rays=2_000_000, replicates=16).error

    firing, incremental = error(), error(order="incremental")
    assert 0.9 < incremental / firing < 1.1
    assert error(order="incremental", estimator="bidirectional") < 0.92 * incremental
    assert error(order="regular", control_variate=True) < 0.85 * firing
    assert error(order="regular", control_variate=True, estimator="bidirectional") < 0.9 * firing


def test_backs_that_let_lines_pass_have_no_second_end():
    scene = rd.load_scene("room")
    from dataclasses import replace

    passing = replace(scene, back=np.full_like(scene.back, int(rd.Back.PASSES)))
    with pytest.raises(rd.MethodError, match="let lines pass"):
        rd.solve(rd.subdivide(passing, cells=2), rd.Method(order="incremental", estimator="bidirectional"), rays=100_000)


def test_black_walls_and_exact_constants_end():
    """Nothing is sent when B is the constant, or when nothing reflects; the run still ends, with the exact value."""
    for rho in (0.0, 0.5):
        for name, choices in VARIANTS.items():
            solution = rd.solve(rd.subdivide(cube(rho, 1.0), cells=2), rd.Method(**choices), rays=200_000, replicates=4)
            assert solution.status == "complete", name
            assert np.abs(solution.irradiance - 1 / (1 - rho)).max() < 0.2, name
            if "control" in name:
                assert np.abs(solution.irradiance - 1 / (1 - rho)).max() < 2e-3, name


@pytest.mark.parametrize("order", ["incremental", "regular"])
def test_stages_share_out_their_probing_lines(order, monkeypatch):
    """One line in eight measures what is missed, however many stages a run has: each fires those that it is short of."""
    monkeypatch.setattr(budget, "FIRST_STAGE", 1 << 14)
    method = rd.Method(order=order, control_variate=True)
    solution = rd.solve(rd.subdivide(cube(0.5, np.add(LIGHT, 0.1)), cells=2), method, quanta=1 << 15, replicates=2)
    assert solution.state["probed"].sum(axis=1) / (1 << 15) == pytest.approx(1 / SHARE, rel=0.02)


@pytest.mark.parametrize("order", ["incremental", "regular"])
def test_the_constant_s_own_light_escapes_where_lines_do(order):
    """Of a cube without one side nothing is lost on backs, whatever is put aside."""
    scene = cube(0.5, np.add(LIGHT, 0.1)).take(np.arange(5))
    solution = rd.solve(rd.subdivide(scene, cells=2), rd.Method(order=order, control_variate=True), rays=100_000, replicates=4)
    for book in solution.books:
        assert book["lost"] == 0
        assert book["escaped"] > 0.1 * book["emitted"]


@pytest.mark.parametrize("seed", range(20))
def test_constants_leave_the_least_power_to_send(seed):
    """Of all constants at which the sums have a corner none does better: of a source, and of a radiosity."""
    random = np.random.Generator(np.random.Philox(seed))
    emission, rho, area = random.random((3, 9)) * [[1.0], [0.98], [2.0]]

    def least(values, weights, wanted):
        power = np.abs(values[:, None] - weights[:, None] * wanted)
        return (area @ power).min()

    corners = emission / (1 - rho)
    found = source_constant(emission, rho, area)
    assert least(emission, 1 - rho, np.array([found])) == pytest.approx(least(emission, 1 - rho, corners), rel=1e-12)
    found = median(emission, area)
    assert least(emission, np.ones(9), np.array([found])) == pytest.approx(least(emission, np.ones(9), emission), rel=1e-12)
