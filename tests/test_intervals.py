"""Are the stated errors true? Intervals against known answers, bounds where few lines landed, and targets that are reached.

Coverage is a mean over runs of different seeds; its own error comes from the runs, since patches of one run share its numbers.
"""

import math

import numpy as np
import pytest
from scipy import stats
from some_cases import some

import radiosity as rd
from radiosity.lab import cases
from radiosity.lab.calibration import LEVELS, coverage
from radiosity.lab.study import Arm
from radiosity.solution import intervals
from radiosity.solution.errors import SURE, inner_products, margin

ALPHA = 1e-4
NOMINAL = {0.9: 0.02, 0.95: 0.015, 0.99: 0.008}  # how far coverage may be off, by the issue of accuracy
VISITED = 100  # arrivals in a run


def arm(method: rd.Method) -> Arm:
    return Arm(str(method), method, "any")


@some(["halton", "sobol", "random"], ["scrambled-halton"])
def test_intervals_hold_the_truth_as_often_as_they_say(name):
    case = cases.maze("labyrinth-0.5")
    found = coverage(arm(rd.Method(numbers=name)), case, cases.ones(case), 3, lines=4_000, seeds=300, visited=VISITED)
    assert found.visited > 0.9
    for level, (share, error) in zip(LEVELS, found.covered, strict=True):
        if level in NOMINAL:
            assert abs(share - level) < NOMINAL[level] + stats.norm.ppf(1 - ALPHA / 2) * error


def test_normal_quantiles_would_be_found_out(monkeypatch):
    """The wrong implementation: no account of eight replicates being few."""
    monkeypatch.setattr("radiosity.lab.calibration.student", lambda level, replicates: stats.norm.ppf(0.5 + level / 2))
    case = cases.maze("labyrinth-0.5")
    found = coverage(arm(rd.Method()), case, cases.ones(case), 3, lines=4_000, seeds=300, visited=VISITED)
    share, error = found.covered[LEVELS.index(0.95)]
    assert share < 0.95 - NOMINAL[0.95] - stats.norm.ppf(1 - ALPHA / 2) * error


@pytest.mark.slow
@pytest.mark.parametrize("lines", [16_000, 500_000])
@pytest.mark.parametrize("name", ["labyrinth-0.5", "labyrinth-0.9", "room", "plates"])
def test_coverage_of_four_scenes(name, lines):
    if name.startswith("labyrinth"):
        case, truth = cases.maze(name), cases.ones(cases.maze(name))
    else:
        case = cases.plates() if name == "plates" else cases.room(3)
        truth = rd.solve(case.patches, "random-walk", rays=600_000_000, replicates=64, seed=987).radiosity[:, 0]
    found = coverage(arm(rd.Method()), case, truth, 1, lines=lines, seeds=200, visited=VISITED)
    for level, (share, _) in zip(LEVELS, found.covered, strict=True):
        if level in NOMINAL:
            assert abs(share - level) < NOMINAL[level], (level, share)


@pytest.fixture(scope="module")
def dim():
    """The room with many small patches and few lines."""
    patches = rd.subdivide(rd.load_scene("room"), cells=12)
    return rd.solve(patches, "random-walk", rays=60_000), rd.solve(patches, "random-walk", rays=4_000_000, seed=5).irradiance


def test_no_line_is_no_certain_zero(dim):
    solution, truth = dim
    none = (solution.arrivals == 0) & (solution.irradiance[:, 0] == 0)  # nor did the residue bring anything
    assert none.sum() > 100
    assert (truth[none] > 0).mean() > 0.9
    quantum, area = 25.6 / solution.quanta / 8, solution.patches.area[:, None]  # the lamp's power is 25.6 W
    usual = intervals.usual_power(solution.irradiance, solution.arrivals, area[:, 0], quantum)
    assert usual == pytest.approx(quantum, rel=0.02)  # the residue is told by signed lines, which are not counted
    assert solution.irradiance_standard_error[none] * area[none] == pytest.approx(np.full((none.sum(), 1), usual[0]))
    low, high = solution.interval(0.95, "irradiance")
    assert (low[none] == 0).all()
    # the bound of no arrivals at 97.5 % is 3.7 lines, or as many clusters of lines; it holds, and is no more than that
    together = intervals.cluster(solution.irradiance, solution.irradiance_standard_error, solution.arrivals, area[:, 0])
    assert 1 <= together < 2
    assert high[none] * area[none] == pytest.approx(np.full((none.sum(), 1), -math.log(0.025) * usual[0] * together[0]))
    assert (truth[none] <= high[none]).mean() > 0.975


def test_bounds_hold_where_few_lines_landed(dim):
    """Two-sided 95 %: the truth is above in 2.5 % of patches at most, and below; they are chosen by what is to be expected, not
    by what came."""
    solution, truth = dim
    power = truth[:, 0] * solution.patches.area
    here = (truth[:, 0] > 0) & (solution.arrivals.sum() * power / power.sum() < intervals.FEW)
    assert here.sum() > 1000
    low, high = solution.interval(0.95, "irradiance")
    assert (truth[here] > high[here]).mean() < 0.02
    assert (truth[here] < low[here]).mean() < 0.01
    assert np.median((high - low)[here] / truth[here]) < 4  # most of them get a few lines: no bound is out of reach
    replicates_alone = solution.irradiance + intervals.student(0.95, 8) * solution.irradiance_standard_error
    assert (truth[here] > replicates_alone[here]).mean() > 0.025  # which the bound is for


def test_all_replicates_equal_by_luck_is_no_certainty():
    mean, arrivals, area = np.array([[2.0], [2.0]]), np.array([8, 800]), np.array([4.0, 4.0])
    error = intervals.least_error(mean, np.zeros((2, 1)), arrivals, area, replicates=8)
    assert error[0, 0] == pytest.approx(2.0 / math.sqrt(8))  # of eight arrivals of one unit each
    assert error[1, 0] == pytest.approx(2.0 / 100 / math.sqrt(12 * 8))  # of a hundred lines in each replicate, known to a line


def test_without_replicates_intervals_are_unknown():
    solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=2), "random-walk", rays=100_000, replicates=1)
    for ends in (solution.interval(quantity="irradiance"), solution.surface_interval(), solution.scene_interval()):
        assert np.isnan(ends).all()
    assert "unknown" in solution.report()


def test_surfaces_have_the_error_of_their_own_means():
    """Not that of patches that are taken for independent: in a maze one shift moves them all."""
    patches = rd.subdivide(rd.load_scene("labyrinth-0.9"), cells=1)
    solutions = [rd.solve(patches, "random-walk", quanta=2048, seed=seed) for seed in range(50)]
    inside = []
    for solution in solutions:
        low, high = solution.surface_interval(0.9, "radiosity")
        inside.append(((low <= 1) & (high >= 1)).mean())
    error = np.std(inside) / math.sqrt(len(solutions))
    assert np.mean(inside) == pytest.approx(0.9, abs=0.02 + stats.norm.ppf(1 - ALPHA / 2) * error)
    surface = solutions[0].surface_power[0].sum(axis=(0, 1)) / 8
    assert surface == pytest.approx(patches.area @ solutions[0].irradiance, rel=1e-9)


def test_saved_intervals_are_read_again(tmp_path):
    solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=2), "random-walk", rays=100_000)
    solution.save(tmp_path / "a.npz")
    again = rd.load_solution(tmp_path / "a.npz")
    assert np.array_equal(again.surface_interval(), solution.surface_interval())
    assert np.array_equal(again.interval(), solution.interval())


@pytest.mark.parametrize(("level", "quantity"), [(0.0, "radiosity"), (1.0, "radiosity"), (95, "radiosity"), (0.9, "emission")])
def test_levels_and_quantities_that_make_no_sense(level, quantity):
    solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), "random-walk", rays=20_000)
    with pytest.raises(rd.MethodError, match=r"level|quantity"):
        solution.interval(level, quantity)


# ---- targets -------------------------------------------------------------------------------------------------------------


def test_the_margin_of_one_patch_is_student_s_and_of_many_none():
    rng = np.random.default_rng(1)
    one = margin(inner_products(rng.normal(size=(8, 1)), np.ones(1)), 8)
    assert one == pytest.approx(stats.t.ppf(0.5 + SURE / 2, 7))
    many = margin(inner_products(rng.normal(size=(8, 200_000)), np.ones(200_000)), 8)
    assert 1 < many < 1.01
    together = margin(inner_products(rng.normal(size=(8, 1)) * np.ones((8, 500)), np.ones(500)), 8)
    assert together == pytest.approx(one, rel=1e-6)


def test_the_margin_holds_as_often_as_it_says():
    """Patches in ten groups that go together."""
    rng, held, runs = np.random.default_rng(2), 0, 2000
    for _ in range(runs):
        values = np.repeat(rng.normal(size=(8, 10)), 7, axis=1)
        stated = np.sqrt((values.var(axis=0, ddof=1) / 8).sum())
        held += np.linalg.norm(values.mean(axis=0)) <= stated * margin(inner_products(values, np.ones(70)), 8)
    assert abs(held / runs - SURE) < 0.025


def errors_at(patches: rd.Patches, truth: np.ndarray, target: float, runs: int) -> np.ndarray:
    """True errors of runs that were to reach a target."""
    weight = patches.area[:, None]
    size = np.sqrt((weight * (truth - patches.emission) ** 2).sum(axis=0))
    found = []
    for seed in range(runs):
        solution = rd.solve(patches, "random-walk", error=target, seed=seed)
        assert solution.status == "complete"
        found.append((np.sqrt((weight * (solution.radiosity - truth) ** 2).sum(axis=0)) / size).max())
    return np.array(found)


DOUBLING = 2**0.6  # how much less the error is after twice as many lines


@pytest.mark.slow
def test_a_target_error_is_reached():
    """Against the truth, in 95 % of runs; and no more than twice the lines are traced that a run of known error needs, in which
    the 95 % quantile of errors would be the target itself."""
    patches = rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1)
    errors = errors_at(patches, np.ones((len(patches), 1)), 0.0018, 25)
    assert stats.binomtest(int((errors <= 0.0018).sum()), 25, SURE, "less").pvalue > 1e-3
    assert np.quantile(errors, 0.95) > 0.0018 / DOUBLING


@pytest.mark.slow
@pytest.mark.parametrize("target", [1, 0.5])
@pytest.mark.parametrize("name", ["labyrinth-0.5", "room", "cornell-box"])
def test_target_errors_of_three_scenes(name, target):
    target *= {"labyrinth-0.5": 0.001, "room": 0.004, "cornell-box": 0.006}[name]
    patches = rd.subdivide(rd.load_scene(name), cells=1 if name.startswith("labyrinth") else 3)
    truth = np.ones((len(patches), 1))
    if not name.startswith("labyrinth"):
        truth = rd.solve(patches, "random-walk", rays=1_600_000_000, replicates=32, seed=987).radiosity
    errors = errors_at(patches, truth, target, 100)
    assert (errors <= target).mean() >= SURE - 0.03  # one and a half standard deviations of a hundred runs
    assert np.quantile(errors, 0.95) > target / DOUBLING


def test_a_surface_reaches_its_error():
    patches = rd.subdivide(rd.load_scene("room"), cells=4)
    solution = rd.solve(patches, "random-walk", error=0.006, error_of="surface:*box")
    rows = {row["surface"]: row["error"] for row in solution.surface_table()}
    assert max(rows["tall box"], rows["low box"]) < 0.012
    usual = rd.solve(patches, "random-walk", error=0.006)
    assert solution.rays > 1.5 * usual.rays  # boxes are small and dim
    assert solution.provenance["budget"] == {"error": 0.006, "error_of": "surface:*box"}


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ("lamp[1]", [0]),  # a name, though it is a pattern for lamp1
        ("lamp1", [1]),
        ("lamp[2]", [2]),  # no name, so a pattern
        ("lamp[12]", [1, 2]),
        ("lamp*", [0, 1, 2, 3]),
        ("*", [4]),
        ("?", [4, 5]),
        ("LAMP1", [6]),
        ("[!l]*", [4, 5, 6]),
    ],
)
def test_a_target_means_the_surface_of_that_name_or_else_a_pattern(asked, found):
    from radiosity.run.error_target import rows_of

    names = ["lamp[1]", "lamp1", "lamp2", "lamp[1]x", "*", "a", "LAMP1"]
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    vertices = np.concatenate([np.column_stack([corners, np.full(4, z)]) for z in range(7)])
    scene = rd.Scene.from_arrays(vertices, np.arange(28).reshape(7, 4), 0.5, 1.0, surface=range(7), names=names, two_sided=True)
    patches = rd.subdivide(scene, cells=2)
    rows = rows_of(patches, f"surface:{asked}")
    assert rows.tolist() == np.flatnonzero(np.isin(patches.surface, found)).tolist()
    assert len(rows) == 8 * len(found)  # both sides of four cells


@pytest.mark.parametrize("name", ["floor", "surface:", "surface:flor", "patch:3"])
def test_surfaces_that_are_not_there(name):
    with pytest.raises(rd.MethodError, match=r"floor|surface:NAME"):
        rd.solve(rd.load_scene("room"), "random-walk", error=0.1, error_of=name)


def test_a_surface_without_an_error_to_reach():
    with pytest.raises(rd.MethodError, match="give the error, too"):
        rd.solve(rd.load_scene("room"), "random-walk", rays=10_000, error_of="surface:floor")


def test_coloured_runs_that_stopped_between_two_rungs_replay():
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    solution = rd.solve(patches, "random-walk", error=0.0035)
    assert solution.quanta & (solution.quanta - 1)
    again = rd.solve(patches, "random-walk", quanta=solution.quanta)
    assert np.array_equal(solution.irradiance, again.irradiance)


def test_the_time_left_follows_the_run_s_own_slope():
    from radiosity.run.budget import Budget
    from radiosity.run.progress import SLOPE, Teller

    teller = Teller(Budget(error=1e-3), None)
    assert teller.slope == SLOPE
    for stage in range(4):
        teller.complete(10**6 << stage, 1 << stage, 0.1 * 2.0 ** (-0.8 * stage))
    assert teller.slope == pytest.approx(0.8, abs=0.03)
    for stage in range(4):  # noise does not turn it round
        teller.complete(10**7 << stage, 16 << stage, 0.01 * 1.01**stage)
    assert 0.3 < teller.slope < SLOPE


def test_powers_near_zero_make_no_overflow():
    """Of a damaged file: errors that are huge beside the values. The cluster is large, and finite."""
    tiny, huge, one = np.full((3, 1), 1e-200), np.full((3, 1), 1e50), np.ones(3)
    together = intervals.cluster(tiny, huge, np.array([1, 2, 3]), one)
    assert together.tolist() == [intervals.MOST_TOGETHER]
    low, high = intervals.irradiance_bounds(tiny, np.array([1, 2, 3]), one, 0.975, together)
    assert np.isfinite(low).all()
    assert np.isfinite(high).all()
