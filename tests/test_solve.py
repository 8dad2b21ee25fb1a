"""Budgets, errors, progress, interruption, and what a solution holds."""

import os
import signal
import threading

import numpy as np
import pytest
from enclosures import cube

import radiosity as rd
from radiosity.algorithms.table import make
from radiosity.device.backend import choose
from radiosity.problem.bands import QUANTUM
from radiosity.problem.model import Problem
from radiosity.tracing.geometry import Geometry


@pytest.fixture(scope="module")
def patches():
    return rd.subdivide(rd.load_scene("room"), cells=5)


@pytest.fixture(scope="module")
def solution(patches):
    return rd.solve(patches, "random-walk", rays=1_000_000)


@pytest.mark.parametrize("rays", [100_000, 1_000_000, 7_654_321])
@pytest.mark.parametrize("replicates", [1, 8])
def test_rays_are_met_within_five_percent(patches, rays, replicates):
    assert abs(rd.solve(patches, "random-walk", rays=rays, replicates=replicates).rays / rays - 1) < 0.05


def test_few_rays_warn(patches):
    with pytest.warns(rd.RadiosityWarning, match="replicates .* quanta"):
        rd.solve(patches, "random-walk", rays=500)


def test_error_target_is_reached(patches):
    solution = rd.solve(patches, "random-walk", error=0.01)
    assert 0.004 < solution.error <= 0.01
    assert solution.status == "complete"


def test_seconds_are_kept_roughly(patches):
    solution = rd.solve(patches, "random-walk", seconds=1.0)
    assert solution.seconds < 10  # a slow machine may compile for long; the loop itself stops in time
    assert solution.rays > 0


def test_error_is_the_area_weighted_rms(patches, solution):
    area, reflected = patches.area, solution.radiosity - patches.emission
    expected = np.sqrt((area @ solution.standard_error[:, 0] ** 2) / (area @ reflected[:, 0] ** 2))
    assert solution.error == pytest.approx(expected)
    algorithm = make(Geometry(patches, choose("cpu")), Problem.of(patches), rd.Method(), 0, 8)
    state = algorithm.read(solution.state, algorithm.sizes)
    values, unit = algorithm.tally.irradiance(algorithm.problem, state, 0)  # hits, and what the residue brings
    assert unit == pytest.approx(25.6 / solution.quanta / QUANTUM)
    spread = values.astype(float).std(axis=0, ddof=1) / np.sqrt(8)
    unit = unit / area
    assert np.allclose(solution.irradiance_standard_error[:, 0], spread * unit, rtol=1e-6)


def test_error_bars_cover_the_truth():
    """Nominal 90 and 99 % Student intervals over the patches of the furnace and 30 seeds."""
    from scipy import stats

    labyrinth = rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1)
    inside = {0.90: 0, 0.99: 0}
    for seed in range(30):
        solved = rd.solve(labyrinth, "random-walk", quanta=8_000, seed=seed)
        t = np.abs((solved.radiosity - 1) / solved.standard_error)
        for level in inside:
            inside[level] += (t < stats.t.ppf(0.5 + level / 2, 7)).mean() / 30
    assert abs(inside[0.90] - 0.90) < 0.02
    assert abs(inside[0.99] - 0.99) < 0.008


def test_one_replicate_has_no_error(patches):
    solution = rd.solve(patches, "random-walk", rays=100_000, replicates=1)
    assert np.isnan(solution.error)
    assert np.isnan(solution.irradiance_standard_error).all()
    assert "unknown" in solution.report()


def test_black_scene_has_known_radiosity_and_an_error_of_irradiance():
    solution = rd.solve(rd.subdivide(cube(0.0, 1.0), cells=3), "random-walk", error=0.05)
    assert np.array_equal(solution.radiosity, solution.patches.emission)
    assert not solution.standard_error.any()
    assert 0 < solution.error <= 0.05


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({}, "exactly one"),
        ({"rays": 1000, "seconds": 1}, "exactly one"),
        ({"rays": 0}, "rays is 0"),
        ({"rays": -5}, "rays is -5"),
        ({"rays": float("nan")}, "rays is nan"),
        ({"rays": "many"}, "rays is 'many'"),
        ({"seconds": 0}, "seconds is 0"),
        ({"error": 1.5}, "below 1"),
        ({"error": 0.1, "replicates": 1}, "2 replicates"),
        ({"rays": 1e20}, "would take centuries"),
        ({"quanta": 2**62}, "would take centuries"),
        ({"rays": 1000, "replicates": 0}, "replicates is 0"),
        ({"rays": 1000, "seed": -1}, "seed is -1"),
        ({"rays": 1000, "method": "magic"}, "'magic' does not exist; known are auto, random-walk"),
        ({"rays": 1000, "equation": "cubic"}, "equation 'cubic' does not exist; known are discrete"),
        ({"rays": 1000, "lines": "curved"}, "lines 'curved' does not exist; known are local"),
        ({"rays": 1000, "order": "sideways"}, "order 'sideways' does not exist; known are depth-first, breadth-first"),
        ({"rays": 1000, "numbers": "lucky"}, "numbers 'lucky' does not exist; known are faure, generalized-faure, halton"),
        ({"rays": 1000, "numbers": "random", "coherent": True}, "coherent"),
        ({"rays": 1000, "order": "depth-first", "coherent": True}, "coherent"),
    ],
)
def test_senseless_choices_are_refused(patches, choices, message):
    with pytest.raises(rd.MethodError, match=message):
        rd.solve(patches, **choices)


def test_unknown_device_is_refused(patches):
    with pytest.raises(rd.DeviceError, match="'abacus' does not exist"):
        rd.solve(patches, "random-walk", rays=1000, device="abacus")


def test_a_scene_without_light_is_refused():
    with pytest.raises(rd.SceneError, match="no surface emits"):
        rd.solve(cube(0.5, 0.0), "random-walk", rays=1000)


def test_solve_wants_a_scene():
    with pytest.raises(rd.MethodError, match="load_scene"):
        rd.solve("room", "random-walk", rays=1000)


def test_progress_is_told(patches):
    told = []
    solution = rd.solve(patches, "random-walk", rays=3_000_000, progress=told.append)
    assert told[0].message == "compiling"
    rays = [p.rays for p in told]
    assert rays == sorted(rays)
    assert rays[-1] == solution.state["fired"].sum()  # the residue's lines come after the last sweep
    assert all(p.fraction is None or 0 <= p.fraction <= 1 for p in told)
    assert told[-1].rays_per_second > 0
    assert told[-1].stage >= 1
    assert told[-1].error > 0


@pytest.mark.parametrize("order", ["breadth-first", "depth-first"])
def test_interruption_returns_the_last_complete_stage(patches, order):
    def listen(progress):
        if progress.stage >= 2:
            os.kill(os.getpid(), signal.SIGINT)

    before = signal.getsignal(signal.SIGINT)
    solution = rd.solve(patches, rays=1e9, replicates=2, order=order, progress=listen)
    assert signal.getsignal(signal.SIGINT) is before
    assert solution.status == "interrupted"
    assert 0 < solution.rays < 1e9
    assert np.array_equal(solution.irradiance, rd.solve(patches, "random-walk", quanta=solution.quanta, replicates=2).irradiance)


def test_interruption_before_the_first_stage_is_a_keyboard_interrupt(patches):
    with pytest.raises(KeyboardInterrupt):
        rd.solve(
            patches,
            "random-walk",
            rays=1e9,
            replicates=2,
            progress=lambda p: p.message == "tracing" and os.kill(os.getpid(), signal.SIGINT),
        )


def test_solve_runs_outside_the_main_thread(patches):
    found = []
    thread = threading.Thread(target=lambda: found.append(rd.solve(patches, "random-walk", rays=50_000)))
    thread.start()
    thread.join()
    assert found[0].status == "complete"


def test_books_close_exactly(solution):
    book = solution.books[0]
    assert book["closes"]
    assert book["emitted"] == pytest.approx(25.6)
    table = solution.surface_table()
    assert sum(row["absorbed"] for row in table) == pytest.approx(book["absorbed"], rel=1e-6)
    assert sum(row["emitted"] for row in table) == pytest.approx(book["emitted"], rel=1e-9)
    assert list(dict.fromkeys(row["surface"] for row in table)) == list(solution.patches.scene.names)
    assert [row["side"] for row in table if row["surface"] == "light"] == ["front", "back"]  # both are lit
    assert len(table) == len(solution.patches.scene.names) + 1


def test_report_says_what_matters(solution):
    text = solution.report()
    for word in ("lines", "8 replicates", "error", "closes exactly", "ceiling", "W/m²"):
        assert word in text


def test_save_and_load(solution, tmp_path):
    solution.save(tmp_path / "room.npz")
    loaded = rd.load_solution(tmp_path / "room.npz")
    for name in ("radiosity", "irradiance", "standard_error", "irradiance_standard_error", "arrivals"):
        assert np.array_equal(getattr(loaded, name), getattr(solution, name))
    assert loaded.patches.scene.hash == solution.patches.scene.hash == loaded.provenance["scene"]
    assert loaded.report() == solution.report()
    assert set(loaded.provenance["versions"]) == {"radiosity", "drjit", "mitsuba", "numpy"}
    assert np.array_equal(loaded.state["arrivals"], solution.state["arrivals"])


@pytest.mark.parametrize("damage", ["missing", "empty", "noise", "truncated", "other"])
def test_damaged_solutions_are_refused(solution, tmp_path, damage):
    path = tmp_path / "x.npz"
    if damage == "other":
        np.savez(path, a=1)
    elif damage != "missing":
        solution.save(path)
        whole = path.read_bytes()
        path.write_bytes({"empty": b"", "noise": bytes(range(256)) * 9, "truncated": whole[: len(whole) // 2]}[damage])
    with pytest.raises(rd.SceneError, match=r"x\.npz"):
        rd.load_solution(path)


def test_unwritable_solution(solution, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(rd.OutputError, match="cannot be written"):
        solution.save(tmp_path / "file" / "x.npz")


QUANTA = 1_250_000  # enough for four stops


@pytest.mark.parametrize("scene", ["room", "cornell-box"])
def test_an_interrupted_run_goes_on_to_the_same_bits(scene, tmp_path):
    """Stopped after every few sweeps, saved, loaded and resumed: the result is that of one run."""
    cut = rd.subdivide(rd.load_scene(scene), cells=4)
    whole = rd.solve(cut, "random-walk", quanta=QUANTA, replicates=2)
    part, stops = None, 0
    while True:
        calls = []

        def listen(progress, calls=calls, first=part is None):
            calls.append(progress)
            if len(calls) >= 3 and (progress.stage >= 1 or not first):
                os.kill(os.getpid(), signal.SIGINT)

        part = rd.solve(cut, "random-walk", quanta=QUANTA, replicates=2, progress=listen if stops < 4 else None, resume=part)
        part.save(tmp_path / "part.npz")
        part = rd.load_solution(tmp_path / "part.npz")
        if part.status == "complete":
            break
        stops += 1
    assert stops == 4
    assert np.array_equal(part.irradiance, whole.irradiance)
    assert part.books == whole.books
    assert all(np.array_equal(part.state[key], whole.state[key]) for key in whole.state)


def test_more_rays_go_on_from_a_solution(patches, solution):
    more = rd.solve(patches, "random-walk", rays=4_000_000, resume=solution)
    assert abs(more.rays / 4_000_000 - 1) < 0.05
    assert np.array_equal(more.irradiance, rd.solve(patches, "random-walk", quanta=more.quanta).irradiance)


def test_going_on_with_something_else_is_refused(patches, solution):
    with pytest.raises(rd.MethodError, match=r"seed \(0 then, 1 now\)"):
        rd.solve(patches, "random-walk", rays=4_000_000, resume=solution, seed=1)
    with pytest.raises(rd.MethodError, match=r"numbers \(halton then, random now\)"):
        rd.solve(patches, rays=4_000_000, resume=solution, numbers="random")
    with pytest.raises(rd.MethodError, match="patches"):
        rd.solve(rd.subdivide(patches.scene, cells=2), "random-walk", rays=4_000_000, resume=solution)
    columns = patches.columns.copy()
    columns[[0, 1]], rows = [1, 25], patches.rows.copy()
    rows[[0, 1]] = [25, 1]
    with pytest.raises(rd.MethodError, match="cut"):
        rd.solve(rd.Patches(patches.scene, columns, rows), "random-walk", rays=4_000_000, resume=solution)
    with pytest.raises(rd.MethodError, match="takes a Solution"):
        rd.solve(patches, "random-walk", rays=4_000_000, resume="room.npz")
    with pytest.raises(rd.MethodError, match="scene"):
        rd.solve(
            rd.subdivide(rd.load_scene("labyrinth"), cells=1),
            "random-walk",
            rays=10**6,
            resume=rd.solve(rd.subdivide(rd.load_scene("labyrinth-0.9"), cells=1), "random-walk", rays=10**6),
        )


def test_a_coloured_run_goes_on_from_a_rung_only():
    cut = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    done = rd.solve(cut, "random-walk", rays=2_000_000, replicates=2)
    with pytest.raises(rd.MethodError, match="no power of two"):
        rd.solve(cut, "random-walk", rays=20_000_000, replicates=2, resume=done)
    rung = rd.solve(cut, "random-walk", quanta=2**19, replicates=2)
    more = rd.solve(cut, "random-walk", quanta=3 * 2**18, replicates=2, resume=rung)
    assert np.array_equal(more.irradiance, rd.solve(cut, "random-walk", quanta=3 * 2**18, replicates=2).irradiance)


def test_numpy_numbers_may_be_saved(patches, tmp_path):
    for budget in ({"quanta": np.int64(1000)}, {"rays": np.float32(50_000)}, {"error": np.float64(0.2)}):
        rd.solve(patches, replicates=np.int64(2), seed=np.uint8(3), **budget).save(tmp_path / "x.npz")
        assert rd.load_solution(tmp_path / "x.npz").provenance["seed"] == 3


def test_nothing_received_is_no_error_to_wait_for():
    plate = rd.Scene.from_arrays([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)], 0.5, 1.0)
    solution = rd.solve(plate, "random-walk", error=0.1)
    assert solution.status == "complete"
    assert "nan" not in solution.report()
    assert solution.escaped[0] == pytest.approx(1.0, rel=1e-4)


def test_too_large_an_emission_is_our_error():
    with pytest.raises(rd.SceneError, match=r"below 1e\+30"):
        rd.solve(cube(0.5, 1e308), "random-walk", rays=1000)


def test_seconds_of_all_legs_are_added(patches, solution):
    assert rd.solve(patches, "random-walk", rays=2_000_000, resume=solution).seconds > solution.seconds
