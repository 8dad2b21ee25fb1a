"""Ctrl-C ends the program with one line and status 130, whenever it comes."""

import os
import signal
import subprocess
import sys
import time

import pytest

import radiosity as rd
from radiosity.cli import main

PROGRAM = "import sys\nfrom radiosity.cli import main\nprint('ready', flush=True)\nsys.exit(main())"
LINE = "radiosity: interrupted"


def heard_by_default():
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a test run in the background may have it ignored


@pytest.mark.parametrize("delay", [0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4])
def test_early_interruptions(delay):
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, "solve", "room", "--cells", "2", "--rays", "20k"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heard_by_default,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.005 + delay)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=120)
    assert process.returncode in (0, 130)
    if process.returncode:
        assert err.startswith(LINE)
        assert err.count("\n") == 1
    else:
        assert err == ""


def scene_that_imports(monkeypatch, folder, name, code):
    """Loading any scene imports a module with this code."""
    (folder / f"{name}.py").write_text(code)
    monkeypatch.syspath_prepend(str(folder))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)

    def load(*_, **__):
        __import__(name)
        time.sleep(5)  # long enough for the interruption that was put off
        raise AssertionError("not interrupted")

    monkeypatch.setattr(rd.scene, "load_with_files", load)
    return before


def test_an_import_is_finished_first(capsys, monkeypatch, tmp_path):
    code = "import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(0.1)\nfinished = True\n"
    before = scene_that_imports(monkeypatch, tmp_path, "interrupted_import", code)
    try:
        assert main(["solve", "room"]) == 130
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert sys.modules.pop("interrupted_import").finished
    err = capsys.readouterr().err
    assert err.startswith(LINE)
    assert err.count("\n") == 1


@pytest.mark.parametrize("error", [NameError, ImportError, None])
def test_an_interruption_that_a_library_swallowed(capsys, monkeypatch, error):
    def load(*_, **__):
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(5)
        except KeyboardInterrupt:
            if error is not None:
                raise error("name '_drjit_ext' is not defined") from None
        return scene, []

    scene = rd.load_scene("room")
    monkeypatch.setattr(rd.scene, "load_with_files", load)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        assert main(["solve", "room", "--cells", "1", "--quanta", "10"]) == 130
    finally:
        signal.signal(signal.SIGINT, before)
    assert capsys.readouterr().err.startswith(LINE)


def test_another_handler_is_left_alone(capsys):
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert main(["--version"]) == 0
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
    capsys.readouterr()
