"""Errors that runs are to reach: what is judged, from how many lines, and how runs end that do not reach them."""

import itertools
import math
import os
import signal
import threading

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli import main
from radiosity.problem.model import Problem
from radiosity.run import budget
from radiosity.run.error_target import nothing_before_lights
from radiosity.run.snapshot import Snapshot
from radiosity.solution.errors import margin, relative_error
from radiosity.solution.intervals import FEW

QUICK = 1 << 13  # quanta of all replicates in the first stage, in place of a million
SIDE, HEIGHT = 0.06, 3.0  # of the sensor, in metres: 1.2e-4 of the lamp's lines reach it


def sensor(side=SIDE, height=HEIGHT, reflectance=0.2) -> tuple[rd.Patches, float]:
    """A lamp of a square metre, a small sensor far above it, and the sensor's irradiance."""
    a, c, h = 0.5 - side / 2, 0.5 + side / 2, height
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (a, a, h), (a, c, h), (c, c, h), (c, a, h)]
    scene = rd.Scene.from_arrays(
        corners, [(0, 1, 2, 3), (4, 5, 6, 7)], [0.0, reflectance], [1.0, 0.0], surface=[0, 1], names=["lamp", "sensor"]
    )
    x, y = np.meshgrid(*2 * [(np.arange(200) + 0.5) / 200 - 0.5])
    return rd.subdivide(scene, cells=1), float((h * h / (math.pi * (x * x + y * y + h * h) ** 2)).mean())


class Drawn:
    """A tally of given values: (replicates, n_patches) for each group, in W."""

    settles, counts_hits = False, True

    def __init__(self, values, arrivals=None, line=1e-9):
        self.values = [np.asarray(value, float) for value in values]
        self.landed = np.full(self.values[0].shape[1], 10**6) if arrivals is None else np.asarray(arrivals)
        self.one = line

    def arrivals(self, problem, state):
        return self.landed

    def irradiance(self, problem, state, group):
        return self.values[group], 1.0

    def line(self, problem, state, group):
        return self.one


def plates(widths, reflectance=0.5, bands=1) -> rd.Patches:
    """Plates of a metre's height side by side, which all shine; of several bands no two are alike."""
    edges = np.concatenate([[0.0], np.cumsum(widths)])
    corners = np.array([[(x, 0, 0), (u, 0, 0), (u, 1, 0), (x, 1, 0)] for x, u in itertools.pairwise(edges)], float)
    n = len(widths)
    rho = np.broadcast_to(np.asarray(reflectance, float).reshape(-1, 1), (n, bands)) * np.linspace(1, 0.8, bands)
    emission = np.ones((n, bands))
    scene = rd.Scene.from_arrays(
        corners.reshape(-1, 3), np.arange(4 * n).reshape(-1, 4), rho, emission, bands=tuple(f"band {b}" for b in range(bands))
    )
    return rd.subdivide(scene, cells=1)


def snapshot(patches, values, **tally) -> Snapshot:
    return Snapshot(Problem.of(patches), Drawn(values, **tally), {}, len(values[0]))


# ---- what the error of several patches and bands is ----------------------------------------------------------------------


def test_the_margin_of_unequal_patches_weighs_their_area():
    """The squared error is a mean over area of irradiance squared, so powers are weighed by rho / sqrt(A): against the covariance
    of sqrt(A) rho H itself."""
    rng, rho = np.random.default_rng(7), np.array([0.9, 0.5, 0.1])
    patches = plates([0.01, 1.0, 30.0], rho)
    irradiance = 1 + 0.1 * rng.normal(size=(8, 3)) * [3.0, 1.0, 0.5]
    found = snapshot(patches, [irradiance * patches.area]).margin()
    apart = (irradiance - irradiance.mean(axis=0)) * np.sqrt(patches.area) * rho
    assert found == pytest.approx(margin(apart @ apart.T, 8), rel=1e-12)
    for wrong in (rho, rho * np.sqrt(patches.area), 1 / np.sqrt(patches.area), rho / patches.area):
        other = (irradiance - irradiance.mean(axis=0)) * patches.area * wrong
        assert abs(margin(other @ other.T, 8) / found - 1) > 0.01  # these would be noticed


def test_the_margin_of_several_bands_is_the_largest():
    rng, patches = np.random.default_rng(3), plates(np.ones(40), bands=2)
    together = 1 + 0.1 * rng.normal(size=(8, 1)) * np.ones((8, 40))  # as one patch
    alone = 1 + 0.1 * rng.normal(size=(8, 40))
    margins = [snapshot(patches, values).margin() for values in ([alone, alone], [alone, together], [together, alone])]
    assert margins[1] == pytest.approx(margins[2])
    assert margins[1] > 1.3 * margins[0]


def test_the_error_of_several_bands_is_the_largest_band_s():
    """Of 1 % and 3 % it is 3 %, not 2 %, nor their root mean square."""
    rho, area, irradiance = np.full((2, 2), 0.5), np.array([1.0, 3.0]), np.full((2, 2), 4.0)
    error = irradiance * [0.01, 0.03]
    assert relative_error(rho, irradiance, error, area) == pytest.approx(0.03)
    assert relative_error(rho[:, ::-1], irradiance[:, ::-1], error[:, ::-1], area) == pytest.approx(0.03)
    values = [1 + share * np.array([[1.0], [-1.0]]) * np.ones((2, 2)) for share in (0.01, 0.03)]  # of two replicates
    patches = plates([1.0, 3.0], bands=2)
    assert snapshot(patches, [value * patches.area for value in values]).error() == pytest.approx(0.03)


def test_a_band_that_nothing_landed_in_has_no_known_error():
    rho, area = np.full((2, 2), 0.5), np.ones(2)
    irradiance, error = np.array([[4.0, 0.0]] * 2), np.array([[0.04, 0.1]] * 2)
    assert math.isnan(relative_error(rho, irradiance, error, area))
    assert relative_error(rho, irradiance, error * [1, 0], area) == pytest.approx(0.01)  # a band without light is dark for sure


# ---- when it is judged ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("count", "judged"), [(1, False), (3, False), (4, True), (40, True)])
def test_one_patch_is_judged_from_thirty_lines_on(count, judged):
    """Eight replicates of one count each: 8, 24, 32 and 320 lines; that they agree is luck."""
    patches, line = plates([1.0]), 0.1
    found = snapshot(patches, [np.full((8, 1), count * line)], arrivals=[8 * count], line=line)
    assert found.judged() == judged
    assert found.error() > 0  # equal replicates are no certainty
    floor = 1 / math.sqrt(8 * count) if 8 * count < FEW else 1 / (count * math.sqrt(12 * 8))
    assert found.error() == pytest.approx(floor)


def test_many_patches_of_few_lines_are_judged_together():
    rng = np.random.default_rng(5)
    counts = rng.poisson(0.5, (8, 100))
    line = 0.01
    found = snapshot(plates(np.ones(100)), [counts * line], arrivals=counts.sum(axis=0), line=line)
    assert found.judged()  # some 400 lines
    assert not found.judged(np.array([3, 4]))


def test_what_one_patch_adds_decides_where_it_is_most_of_the_error():
    """Three thousand lines on a large dim patch do not tell the error of a small bright one that three reached."""
    rng, line = np.random.default_rng(6), 1e-3
    counts = np.stack([rng.poisson(3000 / 8, 8), [1, 0, 1, 0, 0, 0, 1, 0]], axis=1)
    small = plates([1.0, 1e-4])
    assert not snapshot(small, [counts * line], arrivals=counts.sum(axis=0), line=line).judged()
    assert snapshot(plates([1.0, 1.0]), [counts * line], arrivals=counts.sum(axis=0), line=line).judged()


def test_two_red_lines_among_a_thousand_blue_ones_are_two():
    rng, line = np.random.default_rng(8), 0.1
    blue = rng.poisson(125, (8, 1)) * line
    red = np.array([1, 0, 0, 0, 1, 0, 0, 0])[:, None] * line
    patches = plates([1.0], bands=2)
    assert not snapshot(patches, [blue, red], arrivals=[1002], line=line).judged()
    assert snapshot(patches, [blue, blue], arrivals=[1002], line=line).judged()


# ---- runs ----------------------------------------------------------------------------------------------------------------


@pytest.fixture
def quick(monkeypatch):
    """Stages begin small, so that the first ones see none of the sensor's lines."""
    monkeypatch.setattr(budget, "FIRST_STAGE", QUICK)


def off(solution: rd.Solution, truth: float) -> float:
    return abs(solution.irradiance[1, 0] / truth - 1)


@pytest.mark.usefixtures("quick")
def test_a_target_that_no_line_tells_of_goes_on():
    """The first stage has one line for the sensor; 12 seeds all come within a quarter, which 95 % of runs are to."""
    patches, truth = sensor()
    first = rd.solve(patches, "random-walk", quanta=QUICK // 8)
    assert first.arrivals[1] < 5
    errors = []
    for seed in range(12):
        solution = rd.solve(patches, "random-walk", error=0.25, error_of="surface:sensor", seed=seed)
        assert solution.status == "complete"
        assert solution.arrivals[1] >= FEW
        errors.append(off(solution, truth))
    assert np.sum(np.array(errors) > 0.25) <= 2  # 3 or more with a probability of 2 %


@pytest.mark.slow
@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("numbers", ["halton", "random"])
@pytest.mark.parametrize("target", [0.5, 0.2, 0.1])
def test_targets_of_few_lines_are_reached_in_95_percent(numbers, target):
    """200 runs; at 95 % fewer than 182 have a probability of 1 %."""
    patches, truth = sensor()
    errors = [
        off(rd.solve(patches, error=target, error_of="surface:sensor", seed=seed, numbers=numbers), truth) for seed in range(200)
    ]
    assert (np.array(errors) <= target).sum() >= 182


def means_of(target: float, seeds: int, **choices) -> tuple[int, list[float]]:
    """How many runs to an error of the sensor's mean, over nine patches, come within it, and all errors."""
    alone, truth = sensor()
    patches = rd.subdivide(alone.scene, cells=3)
    errors = []
    for seed in range(seeds):
        solution = rd.solve(patches, "random-walk", error=target, error_of="mean:sensor", seed=seed, **choices)
        assert solution.status == "complete"
        assert solution.surface_table()[1]["interval"] <= target * (1 + 1e-9)  # Student's interval is what it goes by
        errors.append(abs(float(solution.irradiance[9:, 0].mean()) / truth - 1))
    return int((np.array(errors) <= target).sum()), errors


@pytest.mark.usefixtures("quick")
def test_a_mean_reaches_its_target():
    """12 seeds: 9 or fewer within the target have a probability of 2 %; and the target is no more than a few times too strict."""
    held, errors = means_of(0.3, 12)
    assert held >= 10
    assert max(errors) > 0.03


@pytest.mark.slow
@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("numbers", ["halton", "random"])
@pytest.mark.parametrize("target", [0.3, 0.1])
def test_means_reach_their_targets_in_95_percent(numbers, target):
    """100 runs; at 95 % fewer than 89 have a probability of 1 %."""
    assert means_of(target, 100, numbers=numbers)[0] >= 89


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(("limit", "why"), [({"rays": 40_000}, "rays=40000"), ({"seconds": 1e-3}, "seconds=0.001")])
def test_a_limit_ends_a_run_to_an_error(limit, why):
    patches, _ = sensor()
    with pytest.warns(rd.RadiosityWarning, match=rf"error 10% of surface:sensor was not reached: after .* lines .*{why}"):
        solution = rd.solve(patches, "random-walk", error=0.1, error_of="surface:sensor", **limit)
    assert solution.status == "not reached"
    assert solution.rays < 60_000
    assert "not reached: the error asked for was 10%" in solution.report()
    assert solution.provenance["budget"] == {"error": 0.1, "error_of": "surface:sensor", **limit}


@pytest.mark.usefixtures("quick")
def test_what_is_known_of_an_error_is_how_many_lines_landed_on_its_surface():
    """A screen beside it receives more."""
    alone, _ = sensor()
    scene = alone.scene
    screen = rd.Scene.from_arrays(
        [*scene.vertices, (1, 0, 1), (1, 1, 1), (2, 1, 1), (2, 0, 1)],
        [(0, 1, 2, 3), (4, 5, 6, 7), (8, 9, 10, 11)],
        [0.0, 0.2, 0.0],
        [1.0, 0.0, 0.0],
        surface=[0, 1, 2],
        names=["lamp", "sensor", "screen"],
    )
    patches = rd.subdivide(screen, cells=1)
    with pytest.warns(rd.RadiosityWarning, match="surface:sensor was not reached") as told:
        solution = rd.solve(patches, "random-walk", error=0.01, error_of="surface:sensor", rays=QUICK)
    landed = int(solution.arrivals[1])
    assert landed < FEW
    assert solution.arrivals[2] > 100
    text = next(str(w.message) for w in told if "not reached" in str(w.message))
    assert f"after {solution.rays:,} lines it cannot be told yet ({landed:,} lines hit it)" in text


@pytest.mark.usefixtures("quick")
def test_a_limit_does_not_keep_a_run_from_ending_sooner():
    patches = rd.subdivide(rd.load_scene("room"), cells=2)
    alone = rd.solve(patches, "random-walk", error=0.05)
    limited = rd.solve(patches, "random-walk", error=0.05, rays=50_000_000, seconds=1000)
    assert limited.status == "complete"
    assert np.array_equal(limited.irradiance, alone.irradiance)


@pytest.mark.usefixtures("quick")
def test_a_run_that_did_not_reach_its_error_goes_on():
    patches, _ = sensor()
    with pytest.warns(rd.RadiosityWarning, match="cannot be told yet"):
        short = rd.solve(patches, "random-walk", error=0.25, error_of="surface:sensor", rays=20_000)
    long = rd.solve(patches, "random-walk", error=0.25, error_of="surface:sensor", resume=short)
    assert long.status == "complete"
    assert np.array_equal(long.irradiance, rd.solve(patches, "random-walk", quanta=long.quanta).irradiance)


@pytest.mark.usefixtures("quick")
def test_coloured_runs_end_at_their_limit():
    """Their last stage lies between two powers of two, and no other run begins that the limit has no room for."""
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    with pytest.warns(rd.RadiosityWarning, match="was not reached"):
        solution = rd.solve(patches, "random-walk", error=0.001, rays=300_000)
    assert solution.status == "not reached"
    assert 150_000 < solution.rays < 330_000


@pytest.mark.usefixtures("quick")
def test_a_run_whose_error_stays_unknown_ends(monkeypatch):
    monkeypatch.setattr(budget, "BLIND", 5_000.0)
    patches, _ = sensor()
    with pytest.warns(rd.RadiosityWarning, match="it cannot be told yet .* give more lines as its limit"):
        solution = rd.solve(patches, "random-walk", error=0.1, error_of="surface:sensor")
    assert solution.status == "not reached"


@pytest.mark.usefixtures("quick")
def test_an_interrupted_run_to_an_error_is_no_complete_one():
    if threading.current_thread() is not threading.main_thread():
        pytest.skip("signals reach the main thread alone")
    patches, _ = sensor()

    def stop(progress):
        if progress.stage == 1:
            os.kill(os.getpid(), signal.SIGINT)

    solution = rd.solve(patches, "random-walk", error=1e-3, error_of="surface:sensor", progress=stop)
    assert solution.status == "interrupted"


def test_lights_that_nothing_lies_before():
    """Beside a lamp nothing is lit, and a run to an error ends at once; in front of it, or at its back, something is."""
    plate = plates([1.0, 2.0])
    assert nothing_before_lights(plate)
    assert rd.solve(plate, "random-walk", error=0.1).status == "complete"
    assert not nothing_before_lights(sensor()[0])
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, -1), (1, 0, -1), (0, 1, -1)]
    both = rd.Scene.from_arrays(corners, [(0, 1, 2), (3, 4, 5)], 0.5, [1.0, 0.0], two_sided=True)
    assert not nothing_before_lights(rd.subdivide(both, cells=1))


@pytest.mark.parametrize("given", [{"rays": 1000, "seconds": 1.0}, {"error": 0.1, "quanta": 100}, {"quanta": 10, "rays": 1000}])
def test_budgets_that_do_not_go_together(given):
    with pytest.raises(rd.MethodError, match="exactly one"):
        rd.solve(rd.load_scene("room"), **given)


@pytest.mark.usefixtures("quick")
def test_the_command_line_has_a_status_of_its_own(capsys, tmp_path):
    path = tmp_path / "room.npz"
    assert main(["solve", "room", "--cells", "2", "--error", "0.1%", "--rays", "50k", "-o", str(path)]) == 3
    out, err = capsys.readouterr()
    assert "not reached: the error asked for was 0.1%" in out
    assert "error 0.1% of the scene was not reached" in err
    assert rd.load_solution(path).status == "not reached"
    assert main(["solve", "room", "--cells", "2", "--error", "50%", "--rays", "1M"]) == 0
    assert main(["solve", "room", "--cells", "2", "--error", "50%", "--quanta", "100"]) == 2


# ---- more lines than were asked for --------------------------------------------------------------------------------------

LARGE = {
    "one quantum a replicate": {"method": "random-walk", "rays": 4, "replicates": 16},
    "control variate": {"method": "stochastic-jacobi-control-variate", "rays": 100},
    "global lines": {"method": "global-multipath", "rays": 2},
    "bundles": {"method": "transillumination", "rays": 100},
    "well-distributed": {"method": "wdrs", "rays": 2},
    "staged": {"method": "progressive-ray-refinement", "rays": 2},
    "walks": {"method": "particle-tracing", "rays": 2},
    "baseline": {"method": "progressive-refinement", "rays": 100},
}


@pytest.mark.filterwarnings("ignore:.*quanta for.*patches")
@pytest.mark.filterwarnings("ignore:.*was measured by no line")
@pytest.mark.filterwarnings("ignore:.*ended before progressive")
@pytest.mark.parametrize("name", LARGE)
def test_a_smallest_stage_of_more_lines_is_told(name):
    patches, options = rd.subdivide(rd.load_scene("room"), cells=2), dict(LARGE[name])
    with pytest.warns(rd.RadiosityWarning, match="the smallest stage") as told:
        solution = rd.solve(patches, **options)
    assert solution.rays > 2 * options["rays"]
    text = next(str(w.message) for w in told if "smallest stage" in str(w.message))
    assert text.startswith(
        f"{solution.rays:,} lines were traced, {solution.rays / options['rays']:.3g} times the {options['rays']}"
    )


def test_progress_of_an_error_with_a_limit():
    from radiosity.run.progress import Teller

    seen = []
    teller = Teller(budget.Budget(error=0.01, rays=1000), seen.append)
    teller.lines = 250
    teller.tell("tracing")
    assert seen[-1].fraction == pytest.approx(0.25)
    teller.complete(500, 1, 0.5, math.nan)  # nobody knows yet
    teller.tell("tracing")
    assert seen[-1].fraction == pytest.approx(0.5)
    teller.complete(900, 2, 0.0101)
    teller.tell("tracing")
    assert seen[-1].fraction > 0.9
