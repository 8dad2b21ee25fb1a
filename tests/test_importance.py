"""Importance: closed forms, duality, no bias whatever it is, and errors of what lines are shared out for.

Statistical tests take alpha = 1e-3, shared out among surfaces (Bonferroni); seeds are fixed.
"""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import cube, cube_irradiance
from replicates import powers
from scipy.stats import t as student

import radiosity as rd
from radiosity.algorithms.importance.adjoint import Importance
from radiosity.algorithms.importance.smoothing import Blocks
from radiosity.algorithms.iterations.exchange import LEAST_UNITS, LINE, Exchange, units_of_a_quantum
from radiosity.device.backend import choose
from radiosity.problem.model import Problem
from radiosity.run.budget import first_rung
from radiosity.tracing.geometry import Geometry

METHOD = rd.Method(order="incremental")
REFLECTANCE, EMISSION = np.array([0.9, 0.1, 0.8, 0.2, 0.7, 0.3]), np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
RUNS, ALPHA = 512, 1e-3


def importance(patches: rd.Patches, weights: np.ndarray, seed: int = 1) -> Importance:
    problem = Problem.of(patches)
    geometry = Geometry(problem.patches, choose("cpu"))
    geometry.prepare()
    return Importance.of(geometry, problem, weights, METHOD, seed)


@pytest.fixture(scope="module")
def lit():
    """A cube with one lamp, and the exact irradiance of its walls."""
    return rd.subdivide(cube(REFLECTANCE[:, None], EMISSION[:, None]), cells=1), cube_irradiance(REFLECTANCE, EMISSION)


@pytest.fixture(scope="module")
def rooms():
    return rd.subdivide(rd.load_scene("rooms"), size=0.5)


# ---- what importance is ---------------------------------------------------------------------------------------------


def test_a_furnace_is_as_important_everywhere():
    """Where all light is wanted, that of each patch is worth 1 / (1 - rho): the adjoint is the furnace itself."""
    patches = rd.subdivide(cube(0.5, 1.0), cells=4)
    found = importance(patches, np.ones(len(patches)))
    assert found.adjoint == pytest.approx(6 / (1 - 0.5), rel=0.01)
    assert found.light == pytest.approx(6 / (1 - 0.5), rel=0.01)
    assert np.abs(found.values - 1).max() < 4 / 340**0.5  # standard errors of some 340 hits on each of 96 patches


def test_importance_is_the_adjoint_solution_of_an_unlike_cube(lit):
    """By reciprocity it is the irradiance where what is wanted emits."""
    patches, _ = lit
    wanted = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
    exact = cube_irradiance(REFLECTANCE, wanted)
    np.testing.assert_allclose(importance(patches, wanted).values, exact / exact[0], rtol=0.03)


def test_light_and_importance_tell_the_same_result(lit, rooms):
    """Duality: sum A w H = sum A E K, where light reaches what is wanted at once, and where a millionth of it does."""
    patches, exact = lit
    found = importance(patches, EMISSION[::-1].copy())
    assert found.light == pytest.approx(exact[5], rel=0.03)
    assert found.adjoint == pytest.approx(exact[5], rel=0.03)
    desk = (rooms.surface == rooms.scene.names.index("desk")).astype(float)
    far = importance(rooms, desk)
    assert far.light == pytest.approx(far.adjoint, rel=0.11)
    assert 1e-8 < far.light / 256 < 1e-7
    x = rooms.centroid[:, 0]
    medians = [np.median(far.values[(x > 4 * room) & (x < 4 * room + 4)]) for room in range(5)]
    assert (np.diff(np.log10(medians)) > 0.7).all()  # each room is worth many times the one before


def test_a_value_from_no_hits_is_that_of_its_block():
    """Blocks without any hit have the least value of all others, so that no patch is worth nothing."""
    area, levels = np.ones(5), (np.array([0, 0, 0, 1, 1]), np.array([0, 0, 1, 2, 2]))
    found = Blocks(area, levels).smooth(np.array([1e6, 1e6, 0.0, 0.0, 0.0]), np.array([1e6, 1e6, 0, 0, 0]))
    assert found[0] == pytest.approx(1e6, rel=1e-4)
    assert 0 < found[2] == pytest.approx(2e6 / 3, rel=1e-4)
    assert found[3] == found[4] == found.min()


# ---- no bias --------------------------------------------------------------------------------------------------------


def largest_t(lit, monkeypatch, values: np.ndarray, quanta: int) -> tuple[float, float]:
    """The largest t of all walls, and the bound that it exceeds with probability ALPHA if there is no bias."""
    patches, exact = lit
    monkeypatch.setattr("radiosity.run.aim.Aim.shared", lambda *_: Importance(values, 0.0, 0.0, 0))
    solution = rd.solve(patches, METHOD, quanta=quanta, replicates=RUNS, seed=3, importance="surface:wall 3", numbers="random")
    power = powers(solution)
    t = (power.mean(axis=0) - exact) / (power.std(axis=0, ddof=1) / RUNS**0.5)
    return float(np.abs(t).max()), float(student.ppf(1 - ALPHA / 2 / 6, RUNS - 1))


CYLINDER = 0.10995  # share of the ceiling, by a sum of sin / pi^2 over directions
SHARES = np.array([1.0, 30.0, 0.01, 3.0, 0.2, 100.0])


def test_no_importance_has_a_bias(lit, monkeypatch):
    """Also one that is wrong: lines of a hundredth of a quantum, and of a hundred quanta that a patch rarely sends."""
    largest, bound = largest_t(lit, monkeypatch, SHARES, 20)
    assert largest < bound


def test_lines_that_are_shared_out_but_not_weighted_are_rejected(lit, monkeypatch):
    """Each line carries a quantum, whoever fires it: the same test sees it."""
    send = Exchange.send

    def unweighted(self, power, expected, *more):
        return send(self, power * self.importance * (self.unit / LINE), expected, *more)

    monkeypatch.setattr(Exchange, "send", unweighted)
    largest, bound = largest_t(lit, monkeypatch, np.array([1.0, 1.1, 0.9, 1.0, 0.8, 1.2]), 160)
    assert largest > 2 * bound


def test_lines_of_important_patches_have_enough_units():
    assert units_of_a_quantum(None) == units_of_a_quantum(np.ones(2)) == LINE
    values = np.array([0.1, 2.0**25])
    assert units_of_a_quantum(values) / values.max() >= LEAST_UNITS


# ---- runs -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def desk(rooms):
    return rd.solve(rooms, error=0.1, importance="surface:desk", seed=2)


def test_the_error_of_what_lines_are_for_is_reached(rooms, desk):
    """Ten times better than that of all patches, by few lines; energy balances to the unit."""
    assert desk.status == "complete"
    power = desk.surface_power[0][:, rooms.scene.names.index("desk"), 0]
    assert power.std(ddof=1) / 8**0.5 / power.mean() < 0.1
    assert desk.books[0]["closes"]
    assert "shared out for surface:desk" in desk.report()


def test_sensors_see_a_billionth_of_the_brightest_light(rooms, desk):
    """What they gather from the same solution is what falls on the desk; units of the usual size would lose a third."""
    top = (rooms.surface == rooms.scene.names.index("desk")) & (rooms.normal[:, 2] > 0.5)
    exact = float(desk.irradiance[top, 0] @ rooms.area[top] / rooms.area[top].sum())
    points = [(18.5 + 0.2 * i, 1.5 + 0.2 * k, 0.745) for i in range(4) for k in range(6)]
    found = rd.measure(desk, rd.Sensors.of(points), rays=100_000)
    assert float(found.illuminance.mean()) == pytest.approx(exact, rel=0.05)


def test_a_run_goes_on_to_the_same_bits(lit, tmp_path):
    """The importance is part of the state: files, parts of a run and what goes on have the same."""
    patches, _ = lit
    path, given = tmp_path / "wall.npz", {"importance": "surface:wall 3", "seed": 4}
    rung = first_rung("incremental", 2, Problem.of(patches).source.share)
    short = rd.solve(patches, quanta=rung, replicates=2, **given)
    short.save(path)
    longer = rd.solve(patches, quanta=2 * rung, resume=rd.load_solution(path), replicates=2, **given)
    whole = rd.solve(patches, quanta=2 * rung, replicates=2, **given)
    assert (longer.irradiance == whole.irradiance).all()
    assert longer.rays == whole.rays
    with pytest.raises(rd.MethodError, match="importance"):
        rd.solve(patches, METHOD, quanta=2 * rung, resume=short, replicates=2, seed=4)
    parts = [rd.solve(patches, quanta=rung, replicates=1, first_replicate=r, all_replicates=2, **given) for r in (0, 1)]
    merged = rd.merge(parts)
    assert (merged.irradiance == short.irradiance).all()
    assert merged.provenance["importance"] == "surface:wall 3"


def test_a_pilot_that_takes_all_lines_leaves_as_many(rooms):
    """A run of next to no lines would show a dark desk. Whoever asked for few lines is told."""
    given = {"importance": "surface:desk", "replicates": 2, "seed": 4}
    with pytest.warns(rd.RadiosityWarning, match=r"the pilot that finds importance took [\d,]+ lines, and 20,000 were asked for"):
        few = rd.solve(rooms, rays=20_000, **given)
    pilot = few.provenance["importance_lines"]
    assert 1.7 * pilot < few.rays < 2.6 * pilot
    assert few.surface_power[0][:, rooms.scene.names.index("desk"), 0].all()


def test_a_run_to_lines_goes_on_to_its_lines(lit):
    """Those of the pilot count in a run that goes on as in one that was not stopped."""
    patches, _ = lit
    given = {"importance": "surface:wall 3", "replicates": 2, "seed": 4}
    rung = first_rung("incremental", 2, Problem.of(patches).source.share)
    short = rd.solve(patches, quanta=rung, **given)
    whole = rd.solve(patches, rays=6_000_000, **given)
    longer = rd.solve(patches, rays=6_000_000, resume=short, **given)
    assert (longer.irradiance == whole.irradiance).all()
    assert longer.rays == whole.rays


def test_sensors_and_cameras_see_by_closed_forms():
    """A sensor in the middle of a unit cube that looks up: the ceiling has 4 times the factor of a corner (Howell, B-4)."""
    from radiosity.algorithms.importance.sight import shares_seen
    from radiosity.sensors.sight import sight

    patches = rd.subdivide(cube(0.5, 1.0), cells=1)
    geometry = Geometry(patches, choose("cpu"))
    middle = (0.5, 0.5, 0.5)
    a = 1 / 2**0.5  # both sides of a quarter of the ceiling over the root of 1 + its square
    corner = 2 * a * np.arctan(a) / (2 * np.pi)
    for kind, ceiling in (("plane", 4 * corner), ("cylindrical", CYLINDER)):
        _, origins, ways = sight(patches.scene, rd.Sensors.of([middle], kind=kind))
        share = shares_seen(geometry, patches, origins, ways)
        assert share.sum() == pytest.approx(1)
        assert share[patches.centroid[:, 2] > 0.99][0] == pytest.approx(ceiling, abs=2e-3)
    _, origins, ways = sight(patches.scene, rd.Camera(middle, (0.5, 0.5, 1.0), (0, 1, 0), fov=60, width=90, height=90))
    assert shares_seen(geometry, patches, origins, ways)[5] == pytest.approx(1)


def test_cameras_count_from_0_as_those_of_pictures_do():
    from radiosity.sensors.sight import sight

    rooms = rd.load_scene("rooms")
    first, second = rooms.cameras[0], rd.Camera((1.0, 1.0, 1.5), (2.0, 1.0, 1.0))
    two = replace(rooms, cameras=(first, second))
    for given, camera in (("camera", first), ("camera:0", first), ("camera:1", second)):
        _, origins, ways = sight(two, given)
        _, wanted, towards = sight(two, camera)
        assert (origins == wanted).all()
        assert (ways == towards).all()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"importance": "surface:no such"}, "no surface is called"),
        ({"importance": "walls"}, "surface:NAME"),
        ({"importance": 3}, "int"),
        ({"importance": "camera:1"}, r"camera 1; the scene has 1 \(counted from 0\)"),
        ({"importance": "sensors"}, "asks for no sensors"),
        ({"importance": "surface:desk", "method": "gather"}, "incremental"),
        ({"importance": "surface:desk", "order": "incremental", "estimator": "bidirectional"}, "estimator"),
    ],
)
def test_what_cannot_be_shared_out_is_refused(given, message):
    with pytest.raises(rd.RadiosityError, match=message):
        rd.solve(rd.load_scene("rooms"), rays=1000, **given)


def test_what_sees_nothing_that_reflects_is_refused():
    black = rd.subdivide(cube(0.0, 1.0), cells=1)
    with pytest.raises(rd.MethodError, match="no patch that reflects"):
        rd.solve(black, rays=1000, importance=rd.Sensors.of([[0.5, 0.5, 0.5]]))
