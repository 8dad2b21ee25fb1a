"""Checkpoints, SIGTERM and full disks on the command line."""

import os
import re
import select
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from command_line import run

import radiosity as rd
from radiosity.cli import checkpoints
from radiosity.image import tables
from radiosity.run import checkpoint as engine_checkpoints

RUN = ("solve", "room", "--method", "random-walk", "--cells", "2", "--quanta", "300k", "--replicates", "2")
PROGRAM = """
import resource, sys
from radiosity.cli import checkpoints, main
from radiosity.device.backend import choose
from radiosity.run import checkpoint
checkpoint.TIMES = checkpoint.EVERY = checkpoints.HALF_A_MINUTE = 0
choose("cpu")
import drjit
drjit.set_thread_count(1)
sys.exit(main())
"""


@pytest.fixture
def soon(monkeypatch):
    """Checkpoints that nobody asked for are written from the first sweep on."""
    monkeypatch.setattr(checkpoints, "HALF_A_MINUTE", 0.0)
    monkeypatch.setattr(engine_checkpoints, "TIMES", 0)


@pytest.fixture
def written(monkeypatch):
    """Paths of the checkpoints that were written."""
    paths = []
    save = engine_checkpoints.save

    def watch(solution, path, **options):
        save(solution, path, **options)
        paths.append(path.name)

    monkeypatch.setattr(engine_checkpoints, "save", watch)
    return paths


def test_one_lies_beside_the_first_output_and_goes_when_all_is_written(capsys, tmp_path, soon, written):
    assert run(capsys, *RUN, "-o", tmp_path / "a.csv", tmp_path / "a.ply")[0] == 0
    assert set(written) == {"a.checkpoint.npz"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "a.ply", "a.surfaces.csv"]


def test_a_named_one_goes_too(capsys, tmp_path, monkeypatch, written):
    monkeypatch.setattr(engine_checkpoints, "TIMES", 0)
    named = engine_checkpoints.Checkpoint(tmp_path / "c.npz", 0)
    monkeypatch.setattr(engine_checkpoints, "Checkpoint", lambda path, **_: named)
    assert run(capsys, *RUN, "--checkpoint", tmp_path / "c.npz")[0] == 0
    assert set(written) == {"c.npz"}
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("options", [("--no-checkpoint", "-o", "a.csv"), ()], ids=["off", "no output"])
def test_none_is_written_where_none_is_wanted(capsys, tmp_path, monkeypatch, soon, written, options):
    monkeypatch.chdir(tmp_path)
    assert run(capsys, *RUN, *options)[0] == 0
    assert written == []


def test_short_runs_write_none(capsys, tmp_path, written):
    assert run(capsys, *RUN, "-o", tmp_path / "a.csv")[0] == 0
    assert written == []


def test_an_earlier_one_is_pointed_at_and_a_resumed_one_removed(capsys, tmp_path):
    kept, output = tmp_path / "a.checkpoint.npz", tmp_path / "a.npz"
    rd.solve(rd.subdivide(rd.load_scene("room"), cells=2), "random-walk", quanta=1000, replicates=2).save(kept)
    status, _, err = run(capsys, *RUN, "-o", output)
    assert status == 0
    assert f"--resume {kept} goes on from" in err
    assert kept.exists()
    assert f"--resume {kept} goes on from" in run(capsys, *RUN, "--checkpoint", kept)[2]
    assert kept.exists()
    status, _, err = run(capsys, *RUN, "-o", output, "--resume", kept)
    assert (status, err) == (0, "")
    assert not kept.exists()


@pytest.mark.parametrize(
    ("status", "written", "named", "outputs", "resumed", "stays", "points"),
    [
        ("interrupted", True, False, ["a.glb", "a.csv"], False, True, True),
        ("interrupted", True, False, ["a.glb", "a.NPZ"], False, False, False),  # that output holds the state, too
        ("interrupted", True, True, ["a.npz"], False, True, True),  # asked for by name
        ("interrupted", False, True, ["a.npz"], False, True, False),  # what is there is of an earlier run
        ("complete", True, False, ["a.glb"], False, False, False),
        ("complete", True, True, ["a.glb"], False, False, False),
        ("complete", False, True, ["a.glb"], False, True, False),
        ("complete", False, False, ["a.glb"], True, False, False),  # it was gone on from, and is done
    ],
)
def test_what_becomes_of_it_in_the_end(tmp_path, status, written, named, outputs, resumed, stays, points):
    kept = tmp_path / "a.checkpoint.npz"
    kept.write_bytes(b"")
    keeper, solution = SimpleNamespace(path=kept, written=written), SimpleNamespace(status=status)
    resume = tmp_path / "." / "a.checkpoint.npz" if resumed else None
    found = checkpoints.finish(keeper, solution, [tmp_path / name for name in outputs], named=named, resume=resume)
    assert found == (str(kept) if points else None)
    assert kept.exists() == stays


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--checkpoint", "a.npz", "-o", "a.npz"), "named twice"),
        (("--checkpoint", "a.npz", "--no-checkpoint"), "exclude each other"),
        (("--checkpoint", "a.csv"), r"is an \.npz file"),
        (("--checkpoint", "file/a.npz"), "is a file, not a folder"),
        (("--checkpoint", "a.npz", "--method", "full-matrix"), "nothing to go on from"),
    ],
    ids=str,
)
def test_a_bad_one_is_refused_before_the_run(capsys, tmp_path, monkeypatch, options, reason):
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("")
    monkeypatch.setattr(rd, "solve", lambda *_, **__: pytest.fail("it ran"))
    status, out, err = run(capsys, "solve", "room", *options)
    assert (status, out) == (2, "")
    assert re.fullmatch(rf"radiosity: error: .*{reason}.*\n", err)


def heard_by_default():
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # `nohup` ignores it
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a test run in the background may have it ignored


def started(*arguments, stdout: int = subprocess.PIPE, stderr: int = subprocess.PIPE) -> subprocess.Popen:
    program = [sys.executable, "-c", PROGRAM, *map(str, arguments)]
    return subprocess.Popen(program, stdout=stdout, stderr=stderr, text=True, preexec_fn=heard_by_default)


def appears(path: Path, process: subprocess.Popen) -> None:
    """Wait until it does."""
    while not path.exists():
        try:
            process.wait(0.02)
        except subprocess.TimeoutExpired:
            continue
        pytest.fail(f"ended before {path.name} was there: {process.communicate()}")


@pytest.mark.parametrize(
    ("number", "status", "method"),
    [
        (signal.SIGTERM, 143, "random-walk"),
        (signal.SIGINT, 130, "auto"),
        pytest.param(signal.SIGINT, 130, "random-walk", marks=pytest.mark.slow),  # each half of it is above
    ],
)
def test_signals_leave_the_state(tmp_path, number, status, method):
    kept, output = tmp_path / "room.checkpoint.npz", tmp_path / "room.csv"
    arguments = ("solve", "room", "--method", method, "--cells", "2", "--replicates", "2", "--rays", "1G", "-o", output)
    process = started(*arguments)
    appears(kept, process)
    process.send_signal(number)
    _, err = process.communicate(timeout=120)
    assert process.returncode == status
    assert err == f"radiosity: interrupted: stopped before the end; --resume {kept} goes on from there\n"
    found = rd.load_solution(kept)
    assert found.status == "interrupted"
    done, cut = found.state["fired" if method == "random-walk" else "cosine"].sum(), found.patches
    more = rd.solve(cut, method, quanta=max(int(found.state["quanta"]), 1 << 19), replicates=2, resume=found)
    assert more.rays >= done > 0
    assert np.array_equal(more.irradiance, rd.solve(cut, method, quanta=more.quanta, replicates=2).irradiance)


ENDS = ((signal.SIGHUP,), (signal.SIGHUP, signal.SIGHUP), (signal.SIGTERM, signal.SIGHUP))
USUAL = ((False, ENDS[0]), (True, ENDS[1]), (False, ENDS[2]))  # each end and each kind of reader; all pairs with the slow tests


@pytest.mark.parametrize(
    ("piped", "numbers"),
    [
        pytest.param(piped, numbers, marks=[] if (piped, numbers) in USUAL else pytest.mark.slow)
        for piped in (False, True)
        for numbers in ENDS
    ],
    ids=str,
)
def test_a_terminal_that_goes_away(tmp_path, numbers, piped):
    """What there is is written, though nobody can be told; and though sessions that end send more than one signal."""
    kept, output, (ours, theirs) = tmp_path / "room.checkpoint.npz", tmp_path / "room.csv", os.pipe() if piped else os.openpty()
    process = started("solve", "room", "--cells", "2", "--rays", "1G", "-o", output, stdout=theirs, stderr=theirs)
    os.close(theirs)
    end = time.monotonic() + 120
    while not (kept.exists() and rd.load_solution(kept).quanta) and time.monotonic() < end:
        if select.select([ours], [], [], 0.1)[0]:
            os.read(ours, 1 << 16)
    for number in numbers:
        if number == signal.SIGHUP:
            with suppress(OSError):
                os.close(ours)
        process.send_signal(number)
        time.sleep(0.001)
    assert process.wait(120) in {128 + number for number in numbers}
    assert output.exists()
    assert rd.load_solution(kept).status == "interrupted"


def test_sigterm_outside_of_a_run(tmp_path):
    """While there is nothing to keep: one line, and the status that shells give."""
    code = (
        "import sys, os, signal, time\nimport radiosity as rd\nfrom radiosity.cli import main\n"
        "rd.scene.load_with_files = lambda *_, **__: (os.kill(os.getpid(), signal.SIGTERM), time.sleep(5))\n"
        "sys.exit(main(['solve', 'room']))"
    )
    for before in ("", "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n"):  # as in the background of a shell
        done = subprocess.run([sys.executable, "-c", before + code], capture_output=True, text=True)
        assert done.returncode == 143
        assert re.fullmatch("radiosity: interrupted: .*\n", done.stderr)


def test_a_library_leaves_sigterm_alone():
    before = signal.getsignal(signal.SIGTERM)
    seen = []
    rd.solve(
        rd.load_scene("room"),
        "random-walk",
        quanta=10,
        replicates=1,
        progress=lambda state: seen.append(signal.getsignal(signal.SIGTERM)),
    )
    assert set(seen) == {before}


def test_failing_outputs_leave_the_solution_in_the_checkpoint(capsys, monkeypatch, tmp_path):
    def fail(*_):
        raise OSError("the disk is full")

    monkeypatch.setattr(tables, "write", fail)
    status, out, err = run(capsys, *RUN, "-o", tmp_path / "a.csv", tmp_path / "a.ply")
    kept = tmp_path / "a.checkpoint.npz"
    assert status == 2
    assert f"wrote {tmp_path / 'a.ply'}" in out
    assert f"the solution was kept in {kept} (make room, then --resume it)" in err
    monkeypatch.undo()
    status, out, err = run(capsys, *RUN, "-o", tmp_path / "a.csv", "--resume", kept)
    assert (status, err) == (0, "")
    assert not kept.exists()


def test_what_had_no_room_beside_the_outputs_is_gone_on_from_elsewhere(capsys, monkeypatch, tmp_path):
    save, output, folder = rd.Solution.save, tmp_path / "a.csv", tmp_path / "elsewhere"
    folder.mkdir()

    def refused(*_):
        raise rd.OutputError("x: cannot be written (No space left on device)")

    with monkeypatch.context() as patch:
        patch.setattr(tempfile, "tempdir", str(folder))
        patch.setattr(tables, "write", refused)
        patch.setattr(rd.Solution, "save", lambda self, path: (refused if path.parent == tmp_path else save)(self, path))
        status, _, err = run(capsys, *RUN, "-o", output)
    kept = re.search(r"the solution was kept in (\S+) \(make room, then --resume it\)", err)
    assert status == 2
    assert kept is not None
    assert Path(kept[1]).is_relative_to(folder)
    status, _, err = run(capsys, *RUN, "-o", output, "--resume", kept[1])
    assert (status, err) == (0, "")


@pytest.fixture
def interruptible():
    """SIGINT is ignored where tests run in the background of a shell."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_an_interruption_while_outputs_are_written_names_the_checkpoint(capsys, monkeypatch, tmp_path, soon, interruptible):
    kept, output = tmp_path / "a.checkpoint.npz", tmp_path / "a.csv"
    whole = rd.solve(rd.subdivide(rd.load_scene("room"), cells=2), "random-walk", quanta=300_000, replicates=2)
    with monkeypatch.context() as patch:
        patch.setattr(rd.Solution, "export", lambda *_, **__: signal.raise_signal(signal.SIGINT))
        status, _, err = run(capsys, *RUN, "-o", output)
    assert status == 130
    assert err == f"radiosity: interrupted: stopped before the end; --resume {kept} goes on from there\n"
    found = rd.load_solution(kept)
    assert (found.status, found.rays) == ("complete", whole.rays)
    assert np.array_equal(found.irradiance, whole.irradiance)
    assert run(capsys, *RUN, "-o", output, "--resume", kept)[0] == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "a.surfaces.csv"]


FULL_DISK = """
import resource, sys
from radiosity.cli import checkpoints, main
from radiosity.run import checkpoint
import radiosity as rd
if sys.argv.pop(1) == "after a checkpoint":
    checkpoint.TIMES = checkpoints.HALF_A_MINUTE = 0
solve, most = rd.solve, 12_000

def filled(*arguments, **options):
    solution = solve(*arguments, **options)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))  # Python ignores SIGXFSZ: a write fails, as on a full disk
    return solution

rd.solve = filled
sys.exit(main())
"""


@pytest.mark.parametrize("when", ["after a checkpoint", "without one"])
def test_a_disk_that_is_full_in_the_end(tmp_path, when):
    """Small outputs are written, large ones named, and so is the checkpoint that there is room to go on from."""
    pytest.importorskip("resource")
    large, small, kept = tmp_path / "a.npz", tmp_path / "a.csv", tmp_path / "a.checkpoint.npz"
    done = subprocess.run(
        [sys.executable, "-c", FULL_DISK, when, *RUN, "-o", str(large), str(small)], capture_output=True, text=True
    )
    assert done.returncode == 2
    assert f"wrote {small}" in done.stdout
    assert done.stderr.count("\n") == 1
    assert f"{large}: cannot be written (File too large)" in done.stderr
    assert small.exists()
    assert not large.exists()
    assert kept.exists() == (when == "after a checkpoint")
    if not kept.exists():
        assert "there was no place for the solution either; make room, and solve the scene again" in done.stderr
        return
    assert f"go on with --resume {kept}" in done.stderr
    found = rd.solve(rd.load_solution(kept).patches, "random-walk", quanta=300_000, replicates=2, resume=rd.load_solution(kept))
    whole = rd.solve(found.patches, "random-walk", quanta=300_000, replicates=2)
    assert np.array_equal(found.irradiance, whole.irradiance)


def test_where_nothing_can_be_written_it_says_so(capsys, monkeypatch, tmp_path):
    def fail(*_, **__):
        raise rd.OutputError("x: cannot be written (No space left on device)")

    monkeypatch.setattr(rd.Solution, "export", fail)
    monkeypatch.setattr(rd.Solution, "save", fail)
    status, _, err = run(capsys, *RUN, "-o", tmp_path / "a.npz")
    assert status == 2
    assert err.count("\n") == 1
    assert "no place for the solution" in err
