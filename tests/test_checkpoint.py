"""Checkpoints: written while a run goes on, and gone on from to the bits of one that was never stopped."""

import os
import signal
import subprocess
import sys
import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from kills import assert_same

import radiosity as rd
from radiosity.algorithms.global_lines import multipath, pooling
from radiosity.algorithms.matrix import algorithm
from radiosity.cli.checkpoints import finish
from radiosity.run import checkpoint as checkpoints
from radiosity.run.checkpoint import Checkpoint
from radiosity.tracing import lanes

RUNS = {
    "firing": ("random-walk", {}),
    "depth-first": ("random-walk", {"order": "depth-first"}),
    "walks": ("particle-tracing", {}),
    "gathering": ("random-walk", {"estimator": "gathering"}),
    "iteration": ("stochastic-jacobi", {}),
    "multipath": ("global-multipath-first-shot", {}),
    "pooling": ("transillumination", {}),
    "matrix": ("global-form-factors", {}),
    "progressive": ("progressive-refinement", {"quanta": 150}),
}


class Killed(Exception):
    """Ends a run as it stands, as a kill would."""


@pytest.fixture(scope="module")
def grey():
    return rd.subdivide(rd.load_scene("room"), cells=2)


@pytest.fixture(scope="module")
def coloured():
    return rd.subdivide(rd.load_scene("cornell-box"), cells=2)


@pytest.fixture
def always(monkeypatch):
    """Written at every sweep, whatever it takes."""
    monkeypatch.setattr(checkpoints, "TIMES", 0)


def stopped(patches, method, path, sweeps: int, **options) -> rd.Solution:
    """The checkpoint of a run that ended after so many sweeps, before the next was told."""
    count = 0

    def listen(state):
        nonlocal count
        count += state.message == "tracing"
        if count > sweeps:
            raise Killed

    with pytest.raises(Killed):
        rd.solve(patches, method, checkpoint=path, checkpoint_every=0, progress=listen, **options)
    return rd.load_solution(path)


@pytest.fixture
def short(monkeypatch, always):
    """And between two sweeps as few lines as can be, so that each kind of run has several."""
    for module, name in (
        (lanes, "CHUNK"),
        (lanes, "CORE_CHUNK"),
        (multipath, "BATCH"),
        (pooling, "BATCH"),
        (algorithm, "LAUNCH"),
    ):
        monkeypatch.setattr(module, name, 1 << 14)


@pytest.mark.parametrize("name", RUNS)
def test_every_kind_of_run_goes_on_from_its_checkpoint(grey, tmp_path, short, name):
    method, options = RUNS[name]
    options = {"quanta": 1 << 16, "replicates": 1 if name == "progressive" else 2} | options
    told = []
    whole = rd.solve(grey, method, progress=lambda state: told.append(state.message), **options)
    kept = stopped(grey, method, tmp_path / "run.npz", told.count("tracing") // 2, **options)
    assert kept.status == "interrupted"
    assert_same(rd.solve(grey, method, resume=kept, **options), whole)


def test_a_first_stage_is_not_lost(coloured, tmp_path, always):
    kept = stopped(coloured, "random-walk", tmp_path / "run.npz", 3, quanta=3 << 18, replicates=2)
    assert (kept.quanta, kept.rays) == (0, 0)
    assert np.isnan(kept.irradiance).all()
    assert "unknown" in kept.report()
    with pytest.raises(rd.OutputError, match="no results yet"):
        kept.export(tmp_path / "x.glb")
    with pytest.raises(rd.OutputError, match="no results yet"):
        rd.image.render(kept, tmp_path / "x.png")
    again = tmp_path / "again.npz"
    kept.export(again)
    more = rd.solve(coloured, "random-walk", resume=rd.load_solution(again), quanta=3 << 18, replicates=2)
    assert_same(more, rd.solve(coloured, "random-walk", quanta=3 << 18, replicates=2))


def test_few_shots_of_progressive_refinement_are_kept(grey, tmp_path, always):
    kept = stopped(grey, "progressive-refinement", tmp_path / "run.npz", 2, quanta=70)
    assert kept.quanta == 0
    assert 0 < kept.state["shots"] < 64  # of the first stage
    more = rd.solve(grey, "progressive-refinement", resume=kept, quanta=70)
    assert_same(more, rd.solve(grey, "progressive-refinement", quanta=70))


def test_later_checkpoints_hold_the_last_complete_stage(coloured, tmp_path, always):
    options = {"quanta": 3 << 19, "replicates": 2}
    first = rd.solve(coloured, "random-walk", quanta=1 << 19, replicates=2)
    kept = stopped(coloured, "random-walk", tmp_path / "run.npz", 50, **options)
    assert kept.quanta == 1 << 19
    assert np.array_equal(kept.irradiance, first.irradiance)
    assert int(kept.state["quanta"]) > kept.quanta


def test_ctrl_c_before_the_first_stage_leaves_a_checkpoint(grey, tmp_path):
    def listen(state):
        if state.message == "tracing":
            os.kill(os.getpid(), signal.SIGINT)

    kept = tmp_path / "run.npz"
    with pytest.raises(KeyboardInterrupt):
        rd.solve(grey, "random-walk", quanta=1 << 20, replicates=2, progress=listen, checkpoint=kept)
    found = rd.solve(grey, "random-walk", quanta=1 << 20, replicates=2, resume=rd.load_solution(kept))
    assert_same(found, rd.solve(grey, "random-walk", quanta=1 << 20, replicates=2))


@pytest.mark.parametrize("budget", [{"quanta": 700_001}, {"rays": 1_500_000}, {"rays": 20_000}, {"error": 0.05}], ids=str)
def test_going_on_from_the_end_changes_nothing(coloured, tmp_path, always, budget):
    """Also where the last stage was no rung of the ladder: a run may be killed as it writes its outputs."""
    whole = rd.solve(coloured, replicates=2, checkpoint=tmp_path / "run.npz", checkpoint_every=0, **budget)
    assert_same(rd.solve(coloured, replicates=2, resume=rd.load_solution(tmp_path / "run.npz"), **budget), whole)


def test_what_cannot_be_resumed_says_so(grey, tmp_path):
    cut, method = rd.subdivide(grey.scene, cells=1), "full-matrix"
    with pytest.raises(rd.MethodError, match="nothing to go on from"):
        rd.solve(cut, method, checkpoint=tmp_path / "run.npz")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)  # of few form factors
        done = rd.solve(cut, method)
    with pytest.raises(rd.MethodError, match="nothing to go on from"):
        rd.solve(cut, method, resume=done)


@pytest.mark.parametrize(
    ("change", "options", "reason"),
    [
        ({"device": "cuda"}, {}, r"device \(cuda then, cpu now\)"),
        ({"versions": {"radiosity": "0.0.1"}}, {}, r"radiosity 0\.0\.1 then, .* now"),
        ({"versions": {"drjit": "1.0"}}, {}, r"drjit 1\.0 then"),
        ({"versions": {"mitsuba": "3.0"}}, {}, r"mitsuba 3\.0 then"),
        ({"versions": {"numpy": "1.0"}}, {}, r"numpy 1\.0 then"),
        ({"cut": "x"}, {}, r"cut \(x then"),
        ({"scene": "x"}, {}, r"scene \(x then"),
        ({}, {"seed": 3}, r"seed \(0 then, 3 now\)"),
        ({}, {"replicates": 3}, r"replicates \(2 then, 3 now\)"),
        ({}, {"method": "particle-tracing"}, r"equation \(discrete then, continuous now\)"),
        ({}, {"numbers": "sobol"}, r"numbers \(halton then, sobol now\)"),
        ({}, {"coherent": True}, r"coherent \(False then, True now\)"),
        ({}, {"method": "progressive-refinement", "replicates": 2}, r"scheme \(None then, progressive now\)"),
    ],
    ids=str,
)
def test_what_differs_is_named(grey, change, options, reason):
    before = rd.solve(grey, "random-walk", quanta=1 << 10, replicates=2, device="cpu")
    facts = dict(before.provenance)
    for name, value in change.items():
        facts[name] = {**facts[name], **value} if isinstance(value, dict) else value
    with pytest.raises(rd.MethodError, match=reason):
        rd.solve(
            grey, **{"quanta": 1 << 11, "replicates": 2, "device": "cpu", "resume": replace(before, provenance=facts)} | options
        )


def test_other_bands_are_another_scene(grey):
    scene = grey.scene
    twice = rd.Scene.from_arrays(
        scene.vertices,
        scene.faces,
        np.repeat(scene.reflectance, 2, axis=1),
        np.repeat(scene.emission, 2, axis=1),
        surface=scene.surface,
        names=scene.names,
        bands=["a", "b"],
    )
    before = rd.solve(rd.subdivide(twice, cells=2), "random-walk", quanta=1 << 10, replicates=2)
    other = rd.Scene.from_arrays(
        scene.vertices,
        scene.faces,
        before.patches.scene.reflectance,
        before.patches.scene.emission,
        surface=scene.surface,
        names=scene.names,
        bands=["a", "c"],
    )
    with pytest.raises(rd.MethodError, match="scene"):
        rd.solve(rd.subdivide(other, cells=2), "random-walk", quanta=1 << 11, replicates=2, resume=before)


@pytest.mark.parametrize(
    ("path", "reason"),
    [("a.glb", r"is an \.npz file"), ("file/a.npz", "is a file, not a folder"), ("folder.npz", "is a folder")],
)
def test_a_bad_place_is_found_before_the_run(grey, tmp_path, monkeypatch, path, reason):
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.npz").mkdir()
    with pytest.raises(rd.OutputError, match=reason):
        rd.solve(grey, "random-walk", quanta=10, checkpoint=tmp_path / path, progress=lambda state: pytest.fail("it ran"))
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["file", "folder.npz"]


@pytest.mark.parametrize("every", [-1, np.nan, "5", True])
def test_intervals_are_seconds(grey, tmp_path, every):
    with pytest.raises(rd.MethodError, match="checkpoint_every is"):
        rd.solve(grey, "random-walk", quanta=10, checkpoint=tmp_path / "a.npz", checkpoint_every=every)


def test_writing_takes_a_thirtieth_of_the_time(coloured, tmp_path, monkeypatch):
    """A clock of our own: a sweep takes a second, and to write takes three."""
    now, at = [0.0], []

    class Clock:
        @staticmethod
        def monotonic():
            return now[0]

    def slow(solution, path, derived):
        now[0] += 3
        at.append(now[0])

    monkeypatch.setattr(checkpoints, "time", Clock)
    monkeypatch.setattr(checkpoints, "save", slow)
    solution = rd.solve(coloured, "random-walk", quanta=10, replicates=1)
    keeper = Checkpoint(tmp_path / "a.npz", 10)
    for _ in range(1000):
        now[0] += 1
        if keeper.due():
            keeper.write(lambda: solution)
    assert at[0] == 12  # what the next sweep would end after is written before it
    assert set(np.diff(at)) == {3 + 3 * checkpoints.TIMES}


def test_a_large_state_waits_for_its_first_checkpoint(grey, tmp_path, monkeypatch):
    now, written = [0.0], []
    monkeypatch.setattr(checkpoints.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(checkpoints, "save", lambda *_, **__: written.append(now[0]))
    large = replace(
        rd.solve(grey, "random-walk", quanta=10, replicates=1), state={"counts": np.broadcast_to(np.uint8(0), (10**9,))}
    )
    keeper = Checkpoint(tmp_path / "a.npz", 10)
    for _ in range(1000):
        now[0] += 1
        if keeper.due():
            keeper.write(lambda: large)
    assert written[0] == pytest.approx(checkpoints.TIMES * 1e9 / checkpoints.RATE, abs=1)


FULL = """
import resource, sys, warnings
import radiosity as rd
from radiosity.run import checkpoint
from radiosity.cli import main
checkpoint.TIMES = 0
folder, size = sys.argv[1], int(sys.argv[2])
cut = rd.subdivide(rd.load_scene("room"), cells=2)
whole = rd.solve(cut, "random-walk", quanta=1 << 18, replicates=2)
resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))  # Python ignores SIGXFSZ: a write fails, as on a full disk
with warnings.catch_warnings(record=True) as told:
    warnings.simplefilter("always")
    found = rd.solve(cut, "random-walk", quanta=1 << 18, replicates=2, checkpoint=folder + "/run.npz", checkpoint_every=0)
assert (found.irradiance == whole.irradiance).all()
for warning in told:
    print(warning.message)
"""


def child(code: str, *arguments, **options) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, "-c", code, *map(str, arguments)], capture_output=True, text=True, **options)


def test_a_full_disk_is_told_once_and_the_old_checkpoint_stays(tmp_path):
    pytest.importorskip("resource")
    (tmp_path / "run.npz").write_bytes(b"from before")
    done = child(FULL, tmp_path, 2000)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") == 1
    assert "run.npz: cannot be written (File too large); the run goes on" in done.stdout
    assert (tmp_path / "run.npz").read_bytes() == b"from before"
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.npz"]


def test_what_a_full_disk_refused_is_tried_again_soon(grey, tmp_path, monkeypatch):
    """A clock of our own: the disk is full from second 25 to 68, and from 120 on; a sweep takes a second.

    Each time is told once.
    """
    now, tried = [0.0], []

    def refused(solution, path):
        tried.append(now[0])
        if 25 <= now[0] < 68 or now[0] >= 120:
            raise rd.OutputError("x: cannot be written (No space left on device)")

    monkeypatch.setattr(checkpoints.time, "monotonic", lambda: now[0])
    keeper = Checkpoint(tmp_path / "a.npz", 30, refused)
    solution = rd.solve(grey, "random-walk", quanta=10, replicates=1)

    def run():
        for _ in range(140):
            now[0] += 1
            if keeper.due():
                keeper.write(lambda: solution)

    with pytest.warns(rd.RadiosityWarning, match="the run goes on") as told:
        run()
    assert tried == [29, 33, 37, 41, 45, 49, 53, 57, 61, 65, 69, 98, 127, 131, 135, 139]
    assert len(told) == 2


@pytest.mark.parametrize(
    ("sweep", "moments"),
    [(1, [29, 58, 87, 116]), (12, [24, 48, 72, 96, 120]), (40, [40, 80, 120])],
    ids=["short", "long", "longer"],
)
def test_long_sweeps_do_not_make_it_late(grey, tmp_path, monkeypatch, sweep, moments):
    """It is written before a sweep that would end after half a minute."""
    now, written = [0.0], []
    monkeypatch.setattr(checkpoints.time, "monotonic", lambda: now[0])
    keeper = Checkpoint(tmp_path / "a.npz", 30, lambda *_: written.append(now[0]))
    solution = rd.solve(grey, "random-walk", quanta=10, replicates=1)
    for _ in range(120 // sweep):
        now[0] += sweep
        if keeper.due():
            keeper.write(lambda: solution)
    assert written == moments


def test_what_workers_have_under_way_counts_as_lost(grey, tmp_path, monkeypatch):
    """Workers give back every ten seconds, the last just after it was written: the next one is as much earlier."""
    now, written = [0.0], []
    monkeypatch.setattr(checkpoints.time, "monotonic", lambda: now[0])
    keeper = Checkpoint(tmp_path / "a.npz", 30, lambda *_: written.append((now[0], now[0] // 10 * 10)))
    solution = rd.solve(grey, "random-walk", quanta=10, replicates=1)
    for _ in range(120):
        now[0] += 1
        if keeper.due(now[0] % 10):
            keeper.write(lambda: solution)
    moments, holds = zip(*written, strict=True)
    assert moments == (29, 49, 69, 89, 109)
    assert max(later - held for later, held in zip(moments[1:], holds, strict=False)) < 30


def test_leftovers_of_killed_processes_are_removed(grey, tmp_path):
    dead = child("import os; print(os.getpid())").stdout.strip()
    left, other, alive = (
        tmp_path / f".{name}.part" for name in (f"run.npz.{dead}", f"runs.npz.{dead}", f"run.npz.{os.getppid()}")
    )
    for path in (left, other, alive):
        path.write_bytes(b"half")
    rd.solve(grey, "random-walk", quanta=10, replicates=1).save(tmp_path / "run.npz")
    assert not left.exists()
    assert other.exists()
    assert alive.exists()


METHOD = rd.Method()
HOLDS = """
import sys
from pathlib import Path
from radiosity.run.held import Hold
hold = Hold()
hold.take(Path(sys.argv[1]))
print(flush=True)
input()
"""


@pytest.mark.skipif(os.name != "posix", reason="other systems have no such locks")
def test_two_runs_of_one_name_do_not_lose_each_others_checkpoints(grey, tmp_path):
    """Another process holds the file from before the first writing of one run, and from before the start of the next.

    Each run keeps its own state, and a run that ends removes none that is held.
    """
    place = tmp_path / "a.npz"
    solution = rd.solve(grey, "random-walk", quanta=10, replicates=1)
    first = Checkpoint.of(place, 0, METHOD)
    place.write_bytes(b"of the other run")
    with subprocess.Popen([sys.executable, "-c", HOLDS, place], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        try:
            assert other.stdout is not None
            assert other.stdout.readline()
            with pytest.warns(rd.RadiosityWarning, match=r"goes on in another process; that of this run is .*a-2\.npz"):
                first.end(replace(solution, status="interrupted"))
            first.end(replace(solution, status="interrupted"))  # its own
            with pytest.warns(rd.RadiosityWarning, match=r"a-3\.npz"):
                second = Checkpoint.of(place, 0, METHOD)
            assert place.read_bytes() == b"of the other run"
            assert rd.load_solution(tmp_path / "a-2.npz").state.keys() == solution.state.keys()
            ended = SimpleNamespace(path=place, written=True)
            finish(ended, solution, [], named=True, resume=place)
            assert place.exists()
        finally:
            other.kill()
    assert [keeper.path.name for keeper in (first, second)] == ["a-2.npz", "a-3.npz"]
    finish(ended, solution, [], named=True, resume=place)
    assert not place.exists()
