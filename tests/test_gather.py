"""Gathers against closed forms, the rule that says which kind of line counts, and the probabilities of lamps.

Means are compared with exact form factors by Student's t over replicates, alpha = 1e-4 for all comparisons of a test together
(Bonferroni, `methods.critical`); seeds are fixed.
"""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import cube, cube_irradiance, lamp_lit, parallel_squares, perpendicular_squares
from methods import critical
from replicates import powers

import radiosity as rd
from radiosity.algorithms.gather import chances as chances_module
from radiosity.algorithms.gather import lines as lines_module
from radiosity.algorithms.gather import tally as tally_module
from radiosity.algorithms.gather import targets as targets_module
from radiosity.algorithms.gather.chances import Chances
from radiosity.algorithms.gather.lamps import Lamps
from radiosity.algorithms.gather.packets import Packets
from radiosity.device.backend import choose
from radiosity.factors.polygons import exchange
from radiosity.factors.polygons.matrix import exact
from radiosity.problem.model import Problem
from radiosity.scene.paint import Paint
from radiosity.scene.sampler import Sampler
from radiosity.scene.shapes import box, quad
from radiosity.tracing.geometry import Geometry

pytestmark = pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of few lines
REPLICATES = 16


def lit(parts, *, back=rd.Back.ABSORBS, triangles: bool = False) -> rd.Scene:
    """A scene of (corners, reflectance, emission), a surface each."""
    corners = np.concatenate([part[0] for part in parts])
    faces = np.arange(len(corners)).reshape(-1, 4)
    index = np.arange(len(faces))
    if triangles:
        faces, index = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]), np.tile(index, 2)
    reflectance, emission = (np.array([part[k] for part in parts], float)[index] for k in (1, 2))
    return rd.Scene.from_arrays(
        corners,
        faces,
        reflectance,
        emission,
        surface=index,
        names=[f"part {i}" for i in range(len(parts))],
        back=[back] * len(faces),
    )


FLOOR = quad((0, 0, 0), (1, 0, 0), (0, 1, 0))
FAR = quad((0.3, 0.2, 1.5), (0, 0.4, 0), (0.5, 0, 0))
NEAR = quad((0.3, 0.2, 0.01), (0, 0.4, 0), (0.5, 0, 0))
BESIDE = quad((0.0, 0.2, 0.02), (0, 0.3, 0), (0, 0, 0.4))  # in a wall that stands on the floor
TILTED = quad((0.2, 0.2, 0.3), (0, 0.4, 0.1), (0.4, 0, 0.2))
LIGHTS = {
    "far": [(FLOOR, 0.0, 0.0), (FAR, 0.0, 3.0)],
    "near": [(FLOOR, 0.0, 0.0), (NEAR, 0.0, 3.0)],
    "beside a wall": [(FLOOR, 0.0, 0.0), (BESIDE, 0.0, 3.0)],
    "both": [(FLOOR, 0.0, 0.0), (FAR, 0.0, 3.0), (BESIDE, 0.0, 0.5)],
}


def geometry_of(scene: rd.Scene, cells: int) -> Geometry:
    return Geometry(rd.subdivide(scene, cells=cells), choose("cpu"))


def solution_by_factors(patches: rd.Patches, factors: np.ndarray) -> np.ndarray:
    """The irradiance of each patch, (n,)."""
    rho, own = patches.reflectance[:, 0], patches.emission[:, 0]
    return factors @ np.linalg.solve(np.eye(len(rho)) - rho[:, None] * factors, own)


def off(patches: rd.Patches, truth: np.ndarray, *, key=None, rays: int = 300_000, **options) -> float:
    """By how much the means of patches (or sums of those of an equal key) are off, in critical values: 1 is the most."""
    solution = rd.solve(patches, "gather", rays=rays, replicates=REPLICATES, seed=7, **options)
    key = np.arange(len(patches)) if key is None else key
    found = powers(solution, key=key)
    wanted = np.bincount(np.unique(key, return_inverse=True)[1], truth * patches.area)
    error = np.maximum(found.std(axis=0, ddof=1) / REPLICATES**0.5, 2e-6 * wanted.max())  # float32 kernels
    return float((np.abs(found.mean(axis=0) - wanted) / error).max() / critical(REPLICATES, len(wanted)))


@pytest.fixture
def as_measured(monkeypatch):
    """Without the balance of power, which mends the sums of wrong values."""
    monkeypatch.setattr(tally_module, "factors", lambda own, reflectance, received, *rest: np.ones_like(received))


# ---- closed forms ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reflectance", [0.0, 0.5, 0.95])
def test_a_furnace_is_exact(reflectance):
    """Every line brings the same, whichever kind counts. Power balances in each replicate, so the mean of the enclosure,
    E / (1 - rho), is exact but for rounding."""
    patches = rd.subdivide(cube(reflectance, 2.0), cells=3)
    solution = rd.solve(patches, "gather", rays=200_000, replicates=REPLICATES, seed=1)
    mean = powers(solution, key=np.zeros(54))[:, 0] / 6
    assert mean == pytest.approx(2.0 / (1 - reflectance), rel=1e-9)
    assert off(patches, np.full(54, 2.0 / (1 - reflectance)), key=np.arange(54)) < 1


def test_a_cube_of_six_patches_has_the_irradiance_of_exact_form_factors():
    reflectance, emission = np.array([0.2, 0.9, 0.5, 0.7, 0.1, 0.8]), np.array([0.0, 0.0, 0.0, 1.0, 0.3, 0.0])
    scene = cube(reflectance[:, None], emission[:, None])
    patches = rd.subdivide(scene, cells=1)
    assert off(patches, cube_irradiance(reflectance, emission)) < 1


@pytest.mark.parametrize("case", [parallel_squares, perpendicular_squares])
def test_squares(case):
    scene, factor = case()
    patches = rd.subdivide(scene, cells=4)
    solution = rd.solve(patches, "gather", rays=1_000_000, replicates=REPLICATES, seed=1)
    found = powers(solution)[:, 1]
    error = found.std(ddof=1) / REPLICATES**0.5
    assert abs(found.mean() - factor) < critical(REPLICATES, 2) * error
    assert error < 1e-3 * factor
    assert powers(solution)[:, 0] == pytest.approx(0)


def test_a_small_sensor_far_away_is_not_balanced_off():
    """No line of the lamp meets it: what escapes, as counted, is all that the lamp emits."""
    sensor = quad((0, 0, 20), (0, 0.05, 0), (0.05, 0, 0))
    patches = rd.subdivide(lit([(FLOOR, 0.0, 1.0), (sensor, 0.0, 0.0)]), cells=1)
    truth = exchange(FLOOR[None], sensor[None])[0] / patches.area[1]
    solution = rd.solve(patches, "gather", rays=20_000, replicates=8, seed=1)
    assert solution.irradiance[1, 0] == pytest.approx(truth, rel=0.01)


@pytest.mark.usefixtures("as_measured")
@pytest.mark.parametrize("triangles", [False, True])
@pytest.mark.parametrize("name", LIGHTS)
def test_direct_light_is_that_of_exact_form_factors(name, triangles):
    geometry = geometry_of(lit(LIGHTS[name], triangles=triangles), 4)
    assert off(geometry.patches, solution_by_factors(geometry.patches, exact(geometry).dense())) < 1


def test_backs_emit_and_receive():
    """A lamp that shines to both sides hangs between a floor and a ceiling that reflect."""
    ceiling = quad((0, 0, 1), (0, 1, 0), (1, 0, 0))
    scene = lit([(FLOOR, 0.5, 0.0), (ceiling, 0.8, 0.0), (TILTED, 0.3, 2.0)], back=rd.Back.RADIATES)
    geometry = geometry_of(scene, 2)
    patches = geometry.patches
    assert patches.is_back.sum() == len(patches) / 2
    key = 2 * patches.surface + patches.is_back
    factors = exact(geometry, rays=4096).dense()  # the lamp hides the ceiling from the floor in part
    truth = solution_by_factors(patches, factors)
    assert off(patches, truth, key=key, rays=200_000) < 1


def test_a_lamp_whose_emission_is_painted():
    """A part of the lamp is dark; shadow rays go there, too."""
    scene = lit(LIGHTS["far"])
    image = np.zeros((4, 4, 1), np.float32)
    image[:3, 1:] = np.arange(9).reshape(3, 3, 1)
    uv = np.broadcast_to(np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32), (2, 4, 2))
    paint = Paint(
        (image,),
        np.array([-1, 0], np.int32),
        uv,
        np.ones((2, 4, 1), np.float32),
        np.inf,
        (Sampler(("clamp", "clamp"), "nearest"),),
    )
    geometry = geometry_of(replace(scene, emission_paint=paint), 4)
    patches = geometry.patches
    assert (patches.emission[patches.surface == 1] == 0).any()
    assert len(np.unique(patches.emission[patches.surface == 1])) > 4
    assert off(patches, solution_by_factors(patches, exact(geometry).dense())) < 1


def test_one_patch_sees_nothing():
    solution = rd.solve(rd.subdivide(lit([(FLOOR, 0.5, 2.0)]), cells=1), "gather", rays=1_000)
    assert solution.irradiance == 0
    assert solution.radiosity == 2
    assert solution.books[0]["escaped"] == pytest.approx(2)


@pytest.mark.parametrize("reflectance", [0.5, 0.9])
def test_few_lines_have_no_bias_beyond_the_stated_one(reflectance):
    """100 runs of one replicate, 27 lines a patch: the mean power of each surface against exact form factors."""
    runs = 100
    geometry = geometry_of(lamp_lit(reflectance), 2)
    patches = geometry.patches
    truth = solution_by_factors(patches, exact(geometry).dense())
    solution = rd.solve(patches, "gather", quanta=27 * len(patches), replicates=runs, seed=3)
    found, wanted = powers(solution), np.bincount(patches.surface, truth * patches.area)
    allowed = critical(runs, len(wanted)) * found.std(axis=0, ddof=1) / runs**0.5
    bias = np.abs(solution.state["first_bias"][..., 0].mean(axis=0)) * 25.0 * patches.area
    assert (np.abs(found.mean(axis=0) - wanted) < allowed + np.bincount(patches.surface, bias)).all()
    assert (allowed < 0.03 * wanted).all()


def bright(patches: rd.Patches, truth: np.ndarray) -> np.ndarray:
    """Keys of patches. Those that receive little share one: few of their lines meet a lamp, so Student's t does not hold."""
    power = truth * patches.area
    return np.where(power < 0.03 * power.max(), -1, np.arange(len(patches)))


# ---- which kind of line counts ---------------------------------------------------------------------------------------


@pytest.mark.usefixtures("as_measured")
@pytest.mark.parametrize("kernel", [0.01, 1 / 3, 1.5])
@pytest.mark.parametrize("name", ["far", "near", "both"])
def test_wherever_the_rule_divides_pairs_of_points_the_sum_is_the_same(monkeypatch, name, kernel):
    monkeypatch.setattr(targets_module, "KERNEL", kernel)
    geometry = geometry_of(lit(LIGHTS[name]), 3)
    truth = solution_by_factors(geometry.patches, exact(geometry).dense())
    assert off(geometry.patches, truth, key=bright(geometry.patches, truth)) < 1


@pytest.mark.parametrize(("kernel", "which"), [(1e9, "brought"), (1e-9, "met")])
def test_at_its_ends_the_rule_leaves_one_kind_of_line(monkeypatch, kernel, which):
    monkeypatch.setattr(targets_module, "KERNEL", kernel)
    solution = rd.solve(rd.subdivide(lit(LIGHTS["both"]), cells=2), "gather", rays=100_000)
    other = {"brought": "met", "met": "brought"}[which]
    assert solution.state[which].any()
    assert not solution.state[other].any()


@pytest.mark.usefixtures("as_measured")
@pytest.mark.parametrize(("cosine", "shadow"), [(0.1, 1.0), (1.0, 0.1)])
def test_rules_that_disagree_are_rejected(monkeypatch, cosine, shadow):
    """Pairs of points between the two count for both kinds of lines, or for none."""
    for name, kernel in (("cosine", cosine), ("shadow", shadow)):
        plain = getattr(lines_module.Lines, name)

        def with_kernel(self, *arguments, _plain=plain, _kernel=kernel, **named):
            monkeypatch.setattr(targets_module, "KERNEL", _kernel)
            return _plain(self, *arguments, **named)

        monkeypatch.setattr(lines_module.Lines, name, with_kernel)
    geometry = geometry_of(lit(LIGHTS["near"]), 3)
    truth = solution_by_factors(geometry.patches, exact(geometry).dense())
    assert off(geometry.patches, truth, key=bright(geometry.patches, truth), rays=1_000_000) > 2


# ---- lamps -----------------------------------------------------------------------------------------------------------


def scattered(seed: int, faces: int = 60) -> rd.Scene:
    """Parallelograms of all sizes that lie and lean anywhere, a third of them lamps, some with both sides."""
    random = np.random.default_rng(seed)
    first, second = random.normal(size=(2, faces, 3)) * random.lognormal(-2, 1, size=(2, faces, 1))
    corners = [quad(o, a, b) for o, a, b in zip(random.uniform(0, 2, (faces, 3)), first, second, strict=True)]
    backs = np.where(random.random(faces) < 0.3, rd.Back.RADIATES, rd.Back.ABSORBS)
    emission = np.where(random.random(faces) < 0.3, random.lognormal(0, 2, faces), 0)
    return rd.Scene.from_arrays(np.concatenate(corners), np.arange(4 * faces).reshape(-1, 4), 0.5, emission, back=backs)


@pytest.mark.parametrize("seed", range(4))
def test_no_lamp_that_light_can_come_from_has_no_chance(monkeypatch, seed):
    """Form factors without obstacles say where it can."""
    geometry = geometry_of(scattered(seed), 2)
    patches, problem = geometry.patches, Problem.of(geometry.patches)
    lamps, n = Lamps(geometry, problem), len(patches)
    lamp, lit_by = lamps.of_patch[:n], np.flatnonzero(lamps.of_patch[:n] >= 0)
    i, j = np.repeat(np.arange(n), len(lit_by)), np.tile(lit_by, n)
    sees = (i != j) & (exchange(patches.corners[i], patches.corners[j]) > 1e-9 * patches.area[i])
    receiver, source = i[sees], j[sees]
    assert len(receiver) > 1000
    for size in (16, 64):
        monkeypatch.setattr(chances_module, "CLUSTER", size)
        packets = Packets(geometry, 1)
        chances = Chances(lamps, packets)
        assert chances.probability.sum(axis=1) == pytest.approx(1, rel=1e-6)
        assert (chances.probability[packets.place[receiver] // size, lamp[source]] > 0).all()
        assert (chances.probability == 0).any() or size == 64  # or nothing is left out at all


@pytest.mark.parametrize("entries", [1, 12, 1 << 22])
def test_groups_of_lamps_give_the_same_mean(monkeypatch, entries):
    monkeypatch.setattr(chances_module, "ENTRIES", entries)
    random = np.random.default_rng(5)
    parts = [(FLOOR, 0.0, 0.0)]
    for x, y, z, emission in random.uniform([0, 0, 0.1, 1], [0.9, 0.9, 1.0, 9], (12, 4)):
        parts.append((quad((x, y, z), (0, 0.1, 0), (0.1, 0, 0)), 0.0, emission))
    geometry = geometry_of(lit(parts), 3)
    chances = Chances(Lamps(geometry, Problem.of(geometry.patches)), Packets(geometry, 1))
    assert len(chances.groups) - 1 == {1: 1, 12: 12, 1 << 22: 12}[entries] or entries == 12
    assert np.add.reduceat(chances.within, chances.groups[:-1]) == pytest.approx(1)
    factors = exact(geometry, rays=1024).dense()
    truth = solution_by_factors(geometry.patches, factors)
    floor = geometry.patches.surface == 0
    assert off(geometry.patches, truth, key=np.where(floor, 0, 1), rays=600_000) < 1


def test_a_floor_that_stands_twice_does_not_darken_the_rest():
    """Both copies receive the light of one, so that more is absorbed than lamps emit: that is no error to be balanced."""
    one = lamp_lit(0.7)
    twice = one.take(np.append(np.arange(one.n_faces), 4))
    first, second = (rd.solve(rd.subdivide(scene, cells=3), "gather", rays=300_000, seed=1) for scene in (one, twice))
    n = len(first.patches)
    assert second.irradiance[:n, 0].mean() == pytest.approx(first.irradiance[:, 0].mean(), rel=5e-3)


def test_outsides_of_a_closed_room_are_left_out_of_tables():
    """Their lines escape and say that they receive nothing; that is not light which came."""
    walls = rd.Scene.from_arrays(*_closed(), 0.5, np.where(np.arange(6) == 1, 10.0, 0.0), surface=np.arange(6), two_sided=True)
    walls = replace(walls, back_emission=walls.back_emission * 0)
    rows = rd.solve(rd.subdivide(walls, cells=3), "gather", rays=100_000).surface_table()
    assert len(rows) == 6
    assert all(row["irradiance"] > 0 for row in rows)


def _closed() -> tuple[np.ndarray, np.ndarray]:
    """Corners and faces of a unit cube."""
    corners = np.array([np.asarray(face) for face in box((0, 0, 0), (1, 1, 1), inward=True)])
    return corners.reshape(-1, 3), np.arange(24).reshape(6, 4)


def test_light_below_whole_units_is_within_the_stated_error():
    """A receiver sees only a sheet that reflects next to nothing: lines count none of it, and no interval is [0, 0]."""
    lamp, sheet = [(0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1)], [(0, 0, 0), (3, 0, 0), (3, 1, 0), (0, 1, 0)]
    screen, receiver = [(1, 0, 0.5), (1, 1, 0.5), (1, 1, 1), (1, 0, 1)], [(1, 0, 1), (1, 1, 1), (3, 1, 1), (3, 0, 1)]

    def solved(reflectance):
        scene = lit([(lamp, [0], [1]), (sheet, [reflectance], [0]), (screen, [0], [0]), (receiver, [0], [0])])
        found = rd.solve(rd.subdivide(scene, cells=1), "gather", rays=100_000, replicates=4, seed=1)
        return found.irradiance[3, 0], found.irradiance_standard_error[3, 0]

    value, error = solved(0.3)
    assert value > 5 * error > 0
    dim, bound = solved(3e-11)  # light reaches the receiver from the sheet alone, in proportion to its reflectance
    assert dim == 0
    assert bound > value * 1e-10
