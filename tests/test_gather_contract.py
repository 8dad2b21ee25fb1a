"""What gathers promise as every method does: the same bits in any stages, threads and parts; lines that are counted; refusals."""

import sys
from hashlib import sha256

import drjit as dr
import numpy as np
import pytest
from enclosures import lamp_lit
from kills import Case, assert_same, killed
from methods import critical
from replicates import powers

import radiosity as rd
from radiosity.algorithms.gather import algorithm as gather
from radiosity.algorithms.gather.packets import SIZE, Packets
from radiosity.algorithms.gather.pilot import LINES
from radiosity.algorithms.gather.shares import FIRST, Shares
from radiosity.device.backend import choose
from radiosity.problem.model import Problem
from radiosity.run import budget, checkpoint
from radiosity.scene.shapes import quad
from radiosity.tracing.geometry import Geometry

pytestmark = pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of few lines


@pytest.fixture(scope="module")
def room() -> rd.Patches:
    return rd.subdivide(rd.load_scene("room"), cells=2)


@pytest.fixture(scope="module")
def coloured() -> rd.Patches:
    return rd.subdivide(rd.load_scene("cornell-box"), cells=2)


class Killed(Exception):
    """Ends a run as it stands, as a kill would."""


def stopped(patches, path, monkeypatch, after: int, **options) -> rd.Solution:
    """The checkpoint of a run that ends after so many looks at it."""
    told = []

    def listen(state):
        told.append(state.message)
        if told.count("tracing") > after:
            raise Killed

    monkeypatch.setattr(checkpoint, "TIMES", 0)
    with pytest.raises(Killed):
        rd.solve(patches, "gather", progress=listen, checkpoint=path, checkpoint_every=0, **options)
    return rd.load_solution(path)


@pytest.mark.parametrize("share", [0.3, 0.9, 1.0, 1.1, 6.0])  # of the quanta that store lines
def test_a_run_that_stops_within_a_stage_goes_on_to_the_same_bits(coloured, tmp_path, monkeypatch, share):
    """Between two slices, while lines are stored and later."""
    options = {"quanta": round(share * FIRST * len(coloured)), "replicates": 3, "seed": 2}
    whole = rd.solve(coloured, "gather", **options)
    monkeypatch.setattr(gather, "SLICE", 3 * options["quanta"] // 7)
    assert_same(rd.solve(coloured, "gather", **options), whole)
    kept = stopped(coloured, tmp_path / "run.npz", monkeypatch, 2, **options)
    assert kept.status == "interrupted"
    assert 0 < int(kept.state["done"]) < options["quanta"]
    assert_same(rd.solve(coloured, "gather", resume=kept, **options), whole)


@pytest.mark.parametrize("quanta", [(5, 10), (10, FIRST), (FIRST, 30), (10, 300), (30, 96), (96, 400)])  # lines of a patch
def test_more_quanta_go_on_from_fewer(room, quanta):
    few, many = (count * len(room) for count in quanta)
    first = rd.solve(room, "gather", quanta=few, replicates=2, seed=2)
    again = rd.solve(room, "gather", quanta=many, replicates=2, seed=2, resume=first)
    assert_same(again, rd.solve(room, "gather", quanta=many, replicates=2, seed=2))


def test_stages_that_are_read_change_nothing(room, monkeypatch):
    """Errors that are looked at on the way, and an error target, end in the bits of the replay."""
    monkeypatch.setattr(budget, "FIRST_STAGE", 1 << 10)
    reached = rd.solve(room, "gather", error=0.02, replicates=4, seed=2)
    assert reached.error <= 0.02
    again = rd.solve(room, "gather", quanta=reached.quanta, replicates=4, seed=2)
    np.testing.assert_array_equal(again.irradiance, reached.irradiance)
    np.testing.assert_array_equal(again.irradiance_standard_error, reached.irradiance_standard_error)
    assert again.rays == reached.rays


@pytest.mark.parametrize("quanta", [12, 30, 300])
def test_replicates_in_parts_are_one_run(coloured, quanta):
    """Three replicates and two, of which none may say when the others' iterations end."""
    options = {"quanta": quanta * len(coloured), "seed": 5}
    parts = [
        rd.solve(coloured, "gather", first_replicate=first, replicates=count, **options) for first, count in ((0, 3), (3, 2))
    ]
    merged, whole = rd.merge(parts), rd.solve(coloured, "gather", replicates=5, **options)
    for name in ("brought", "met", "reflected", "halves", "first_bias", "bias_left", "missed", "cosine", "rays"):
        np.testing.assert_array_equal(merged.state[name], whole.state[name], err_msg=name)
    np.testing.assert_array_equal(merged.irradiance, whole.irradiance)
    np.testing.assert_array_equal(merged.irradiance_standard_error, whole.irradiance_standard_error)


def test_threads_change_nothing():
    before = dr.thread_count()

    def hashes(threads: int) -> list[str]:
        dr.set_thread_count(threads)
        found = []
        for name, choices in (("room", {}), ("cornell-box", {"numbers": "random"}), ("room", {"coherent": "always"})):
            patches = rd.subdivide(rd.load_scene(name), cells=3)
            solution = rd.solve(patches, rd.Method(order="gather", **choices), quanta=100 * len(patches), replicates=2, seed=3)
            found.append(sha256(b"".join(solution.state[key].tobytes() for key in sorted(solution.state))).hexdigest())
            assert dr.thread_count() == threads
        return found

    try:
        one, two = hashes(1), hashes(2)
    finally:
        dr.set_thread_count(before)
    assert len(set(one)) >= 2
    assert one == two


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL on this system")
def test_kills(tmp_path):
    case = Case("room", "gather", 600_000)
    whole = case.solve()
    found, kills = killed(case, tmp_path, 2, 1, 2)
    assert kills
    assert_same(found, whole)


# ---- lines -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rays", [50_000, 1_000_000])
def test_rays_are_all_lines_and_the_pilot_s(room, rays):
    told = []
    solution = rd.solve(room, "gather", rays=rays, progress=lambda state: told.append(state.rays))
    fired = int(solution.state["cosine"].sum(dtype=np.int64) + solution.state["rays"].sum(dtype=np.int64)) * 8
    assert solution.rays == fired + LINES * len(room)
    assert solution.rays == pytest.approx(rays, rel=0.02)  # packets fire whole lines
    assert max(told) == solution.rays


@pytest.mark.parametrize("quanta", [1, 5, 13, 14, 15, 200])
def test_shares_of_lines_never_fall_and_are_n(quanta):
    """Sums are N, but for whole lines of packets, and the least lines of each patch; they grow with N."""
    patches = rd.subdivide(rd.load_scene("room"), cells=4)
    n = len(patches)
    random = np.random.default_rng(1)
    packets = Packets(Geometry(patches, choose("cpu")), 1)
    shares = Shares.of(packets, random.lognormal(0, 2, (2, n)), np.ones(n))
    assert abs(shares.lines(quanta * n) - max(quanta, 4) * n) <= 5 * SIZE
    assert (shares.counts(quanta * n) >= shares.counts(quanta * n - 1)).all()
    assert (shares.counts(quanta * n).sum(axis=0) >= 4).all()


@pytest.mark.parametrize("corners", [3, 4])
def test_no_light_at_all_is_shared_out_evenly(corners):
    """No line brings anything, so no pilot knows where lines are needed."""
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    patches = rd.subdivide(rd.Scene.from_arrays(square[:corners], [list(range(corners))], 0.5, 1.0), cells=1)
    solution = rd.solve(patches, "gather", rays=10_000)
    assert solution.irradiance == 0
    assert solution.radiosity == 1
    assert solution.rays == pytest.approx(10_000, rel=0.02)


def test_seconds_end_a_run(room):
    solution = rd.solve(room, "gather", seconds=0.2)
    again = rd.solve(room, "gather", quanta=solution.quanta)
    np.testing.assert_array_equal(again.irradiance, solution.irradiance)
    assert again.rays == solution.rays > 0


# ---- bands, books, the walk ------------------------------------------------------------------------------------------


def test_colours_are_three_grey_runs():
    """Lines and numbers are those of each other, but shares follow the brightest band: means agree within their errors."""
    rho = np.tile([0.8, 0.5, 0.2], (14, 1))
    scene = lamp_lit(0.5)
    own = scene.emission * [1.0, 0.5, 2.0]

    def of(reflectance, emission, bands):
        return rd.Scene.from_arrays(
            scene.vertices, scene.faces, reflectance, emission, surface=scene.surface, names=scene.names, bands=bands
        )

    options = {"rays": 400_000, "replicates": 16}
    together = rd.solve(rd.subdivide(of(rho, own, ("red", "green", "blue")), cells=2), "gather", seed=1, **options)
    for band in range(3):
        alone = rd.solve(rd.subdivide(of(rho[:, [band]], own[:, [band]], ("grey",)), cells=2), "gather", seed=2, **options)
        error = np.hypot(together.irradiance_standard_error[:, band], alone.irradiance_standard_error[:, 0])
        assert (np.abs(together.irradiance[:, band] - alone.irradiance[:, 0]) < critical(16, 3 * len(error)) * error).all()


def test_bands_in_proportion_are_solved_once():
    scene = lamp_lit(0.5)
    own = np.asarray(scene.emission) * [1.0, 0.5, 2.0]
    scene = rd.Scene.from_arrays(scene.vertices, scene.faces, 0.5, own, surface=scene.surface, names=scene.names)
    solution = rd.solve(rd.subdivide(scene, cells=2), "gather", rays=50_000)
    assert solution.state["met"].shape[-1] == 1
    assert solution.irradiance[:, 2] == pytest.approx(4 * solution.irradiance[:, 1])


def test_the_energy_balance_of_a_closed_box():
    solution = rd.solve(rd.subdivide(lamp_lit(0.5), cells=4), "gather", rays=1_000_000)
    books = solution.books[0]
    assert books["emitted"] == pytest.approx(1.0)
    assert books["absorbed"] == pytest.approx(1.0, rel=1e-12)
    assert books["escaped"] == books["lost"] == 0
    assert abs(books["rounding"]) < 1e-12


@pytest.mark.parametrize(("name", "cells"), [("room", 3), ("cornell-box", 3), ("labyrinth-0.5", 1)])
def test_surfaces_agree_with_the_random_walk(name, cells):
    """Student's t over surfaces and bands, alpha = 1e-4 together; the walk has ten times the lines."""
    patches = rd.subdivide(rd.load_scene(name), cells=cells)
    one = rd.solve(patches, "gather", rays=400_000, replicates=16, seed=1)
    other = rd.solve(patches, "random-walk", rays=4_000_000, replicates=16, seed=2)
    for group in range(Problem.of(patches).groups.n_groups):
        ours, theirs = powers(one, group=group), powers(other, group=group)
        error = np.hypot(ours.std(axis=0, ddof=1), theirs.std(axis=0, ddof=1)) / 4
        most = critical(16, 3 * ours.shape[1]) * error
        assert (np.abs(ours.mean(axis=0) - theirs.mean(axis=0)) <= most + 1e-6 * theirs.mean()).all()


# ---- refused ---------------------------------------------------------------------------------------------------------


def test_backs_that_let_lines_pass_are_refused_with_the_reason():
    corners = np.concatenate([quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 1), (0, 1, 0), (1, 0, 0))])
    scene = rd.Scene.from_arrays(corners, np.arange(8).reshape(2, 4), 0.5, [1.0, 0.0], back=[rd.Back.PASSES, rd.Back.ABSORBS])
    reason = "some backs let lines pass, so what a patch sees is not what sees the patch; method gather needs both to be equal"
    with pytest.raises(rd.MethodError, match=f"{scene.source}: {reason}: take --method random-walk"):
        rd.solve(rd.subdivide(scene, cells=1), "gather", rays=1_000)


@pytest.mark.parametrize(
    ("choices", "reason"),
    [
        ({"equation": "continuous"}, "solves the discrete equation only"),
        ({"lines": "global"}, "global lines cross patches as they come"),
        ({"estimator": "survival"}, "leave it out"),
        ({"absorption": "drawn"}, "leave it out"),
        ({"first_shot": 0.3}, "a first shot is for global lines"),
        ({"control_variate": True}, "take --order incremental or regular"),
        ({"warm_up": True}, "only regular iterations"),
        ({"reconstruction": "local-linear"}, "equation continuous"),
    ],
)
def test_choices_that_make_no_sense_are_refused(choices, reason):
    with pytest.raises(rd.MethodError, match=reason):
        rd.Method(order="gather", **choices)


@pytest.mark.parametrize(
    "choices", [{"numbers": "sobol"}, {"numbers": "random"}, {"randomisation": "shared"}, {"coherent": "always"}]
)
def test_other_numbers_solve_the_same_equation(choices):
    patches = rd.subdivide(lamp_lit(0.5), cells=2)
    solution = rd.solve(patches, rd.Method(order="gather", **choices), rays=200_000, replicates=16)
    found = powers(solution, key=np.zeros(len(patches)))[:, 0]
    error = found.std(ddof=1) / 4
    assert abs(found.mean() - 2.0) < critical(16, 4) * error + 2e-6  # the lamp's 1 W, over 1 - 0.5
    assert error < 0.01


def test_packets_traced_together_change_nothing_but_ties(room):
    one, other = (
        rd.solve(room, rd.Method(order="gather", coherent=coherent), rays=100_000, seed=4) for coherent in (False, "always")
    )
    assert one.irradiance == pytest.approx(other.irradiance, rel=1e-3)
    assert one.rays == other.rays
