"""The driver of random commands (tests/fuzz/commands.py): what it takes for wrong, and that job k is always the same."""

import os
import signal
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent / "fuzz"))
import commands as driver
from forks import ended
from jobs import Job, job, near, scene_files

SOLVE, CHECK = ["solve", "room"], ["check", "room"]
ENDS = {
    "done": (SOLVE, 0, "radiosity ...\n", "done"),
    "refused": (SOLVE, 2, "radiosity: error: rays is 0\n", "refused"),
    "not reached": (SOLVE, 3, "radiosity: warning: the error 0.1 was not reached\n", "not reached"),
    "suspicious": (CHECK, 1, "error leak\n", "suspicious"),
    "a signal": (SOLVE, -6, "", None),
    "a signal told by a shell": (SOLVE, 134, "", None),
    "a fault": (SOLVE, 1, f"radiosity: error: {driver.FAULT}, not of your input: KeyError: 1\n", None),
    "a traceback": (SOLVE, 0, "Traceback (most recent call last):\n", None),
    "a status without a word": (SOLVE, 2, "", None),
    "no device": (SOLVE, 1, "radiosity: error: no usable libLLVM\n", None),
    "no end": (SOLVE, None, "", None),
}


@pytest.mark.parametrize("end", ENDS)
def test_ends_are_told_apart(end):
    command, status, output, right = ENDS[end]
    what, wrong = driver.judged(command, status, output)
    assert (wrong is None) == (right is not None)
    assert right in (None, what)


def test_a_job_is_always_the_same_and_jobs_differ():
    jobs = [job(0, number) for number in range(200)]
    assert jobs == [job(0, number) for number in range(200)]
    assert job(1, 0) != job(0, 0)
    words = {word for given in jobs for command in given.commands for word in command}
    assert {"check", "render", "--resume", "--refine-check", "--quanta", "--rays", "a.obj", "a.toml", "room"} <= words


def test_amounts_lie_about_powers_of_two():
    from random import Random

    found = {near(Random(seed), 0, 3) for seed in range(200)}
    assert found == {1, 2, 3, 4, 5, 7, 8, 9}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_what_goes_wrong_in_a_process_is_found(tmp_path, monkeypatch, capsys):
    """A job whose commands are done, refused and ended by a signal, in processes forked from one that waits."""
    commands = [["solve", "a.obj", "--cells", "1", "--quanta", "8", "-o", "o.npz"], ["solve", "no.obj"], ["abort"]]
    harm = "    if command == ['abort']: os.abort()\n"
    source, last = (driver.HERE / "forks.py").read_text(), "    if command is not None:\n"
    assert last in source
    (tmp_path / "forks.py").write_text(source.replace(last, harm + last))
    monkeypatch.setattr(driver, "HERE", tmp_path)
    forks = driver.Forks()
    files = scene_files(("low",), "low", None)
    monkeypatch.setattr(driver, "job", lambda seed, number: Job(files, commands))
    outcome = driver.fuzz(0, 5, 1, tmp_path / "kept", forks)
    forks.close()
    assert outcome.counts == {"done": 1, "refused": 1, "signal 6": 1}
    assert list(outcome.found) == [5]
    assert "abort: ended by a signal" in capsys.readouterr().out
    assert sorted(path.name for path in (tmp_path / "kept" / "commands-0-5").iterdir()) == ["a.mtl", "a.obj", "o.npz"]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_process_without_end_is_ended():
    child = os.fork()
    if child == 0:
        signal.pause()
        os._exit(0)
    assert ended(child, 0.1) is None
    with pytest.raises(ChildProcessError):
        os.waitpid(child, 0)
