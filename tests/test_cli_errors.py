"""Whatever is typed, a failure is one line that starts with ``radiosity:``, and the exit status tells its kind."""

import subprocess
import sys
import warnings

import pytest
from command_line import run

import radiosity as rd
from radiosity.cli import app, main


def one_line(err):
    assert err.startswith("radiosity: error: ")
    assert err.count("\n") == 1
    assert "Traceback" not in err
    return err


WRONG = {
    "an unknown command": (["sovle", "room"], 'Did you mean "solve"'),
    "a missing scene": (["solve"], "SCENE"),
    "an unknown option": (["solve", "room", "--ray", "10"], "--ray"),
    "too many scenes": (["solve", "room", "cornell-box"], "cornell-box"),
    "no rays": (["solve", "room", "--rays", "0"], "'0' must be a whole number"),
    "negative rays": (["solve", "room", "--rays", "-5"], "'-5' must be a whole number"),
    "rays in words": (["solve", "room", "--rays", "many"], "'many' is no count"),
    "an error of zero": (["solve", "room", "--error", "0"], "between 0 and 100 %"),
    "negative seconds": (["solve", "room", "--seconds=-1"], "above zero"),
    "two budgets": (["solve", "room", "--rays", "10", "--seconds", "1"], "--quanta, not --rays and --seconds"),
    "no patch size": (["solve", "room", "--patch-size", "0"], "above zero"),
    "no cells": (["solve", "room", "--cells", "0"], "whole number"),
    "size and cells": (["solve", "room", "--cells", "2", "--patch-size", "1"], "not both"),
    "replicates in words": (["solve", "room", "--replicates", "some"], "'some' is no count; write a whole number"),
    "a part of a replicate": (["solve", "room", "--replicates", "1.5"], "'1.5' must be a whole number from 1"),
    "a seed in words": (["solve", "room", "--seed", "lucky"], "'lucky' is no count; write a whole number"),
    "a negative seed": (["solve", "room", "--seed=-1"], "'-1' must be a whole number from 0"),
    "an exposure of nan": (["solve", "room", "--exposure", "nan"], "'nan' is no exposure; write a number of stops"),
    "an infinite exposure": (["solve", "room", "--exposure", "inf"], "'inf' is no exposure; write a number of stops"),
    "no such device": (["solve", "room", "--device", "xpu"], '"xpu" for --device. Choose from: "auto", "cpu", "cuda"'),
    "no such device to check with": (["check", "room", "--device", "xpu"], '"xpu" for --device'),
    "an output option without a file": (["solve", "room", "-o"], "-o requires at least 1 element"),
    "nothing to go on from": (["solve", "room", "--resume", "nowhere.npz"], "nowhere.npz: no such file"),
    "a log of no false colours": (
        ["render", "nowhere.npz", "-o", "a.png", "--log"],
        "--log: for false colours only; add --false-color",
    ),
    "a range and map of no false colours": (
        ["render", "nowhere.npz", "-o", "a.png", "--range", "0,1", "--color-map", "gray"],
        "--range and --color-map: for false colours only; add --false-color",
    ),
    "a scene where a solution is read": (
        ["render", "room", "-o", "a.png"],
        "room: no such file; solve a scene with -o room.npz first",
    ),
    "no such file": (["solve", "nowhere.obj"], "nowhere.obj: no such file"),
    "no such format": (["solve", __file__], "unknown format '.py'"),
    "a reflectance bound above one": (["solve", __file__, "--max-reflectance", "1.5"], "max_reflectance is 1.5"),
    "no such method": (["solve", "room", "--method", "magic"], "magic"),
    "no such order": (["solve", "room", "--order", "magic"], "magic"),
    "no replicates": (["solve", "room", "--replicates", "0"], "'0' must be a whole number from 1"),
    "a file for a folder": (["solve", "room", "-o", f"{__file__}/room.npz"], "is a file, not a folder"),
    "no experiment": (["experiment"], "name an experiment, or several; known are 1, 2, 3, 4, 5, 6, 7, 8, 9 and all"),
    "one of two experiments that there is not": (["experiment", "1", "99"], "experiment '99' does not exist"),
    "no output format": (["solve", "room", "-o", "room.doc"], ".doc"),
    "one output twice": (["solve", "room", "-o", "a.npz", "./a.npz"], "named twice"),
    "no solution": (["render", "nowhere.npz", "-o", "a.png"], "nowhere.npz"),
    "no picture": (["render", "nowhere.npz"], "output"),
    "a mesh as a picture": (["render", "nowhere.npz", "-o", "a.glb"], "pictures are .png or .exr"),
    "half a camera": (["render", "nowhere.npz", "-o", "a.png", "--origin", "1,2"], "'1,2' is not 3 numbers"),
    "half a range": (["render", "nowhere.npz", "-o", "a.png", "--range", "3"], "'3' is not 2 numbers"),
    "check without a scene": (["check"], "SCENE"),
}


@pytest.mark.parametrize(("arguments", "text"), WRONG.values(), ids=WRONG)
def test_wrong_input_is_one_line_and_status_2(capsys, monkeypatch, tmp_path, arguments, text):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, *arguments)
    assert status == 2
    assert text in one_line(err)
    assert out == ""
    assert list(tmp_path.iterdir()) == []


def test_debug_shows_the_traceback(tmp_path):
    with pytest.raises(rd.SceneError):
        main(["solve", str(tmp_path / "nowhere.obj"), "--debug"])


@pytest.mark.parametrize(
    ("error", "status", "text"),
    [
        (rd.DeviceError("no usable\n  libLLVM"), 1, "radiosity: error: no usable libLLVM\n"),
        (MemoryError(), 1, "radiosity: error: out of memory; take larger patches"),
        (
            ZeroDivisionError("division by zero"),
            1,
            "a fault of the program, not of your input: ZeroDivisionError: division by zero",
        ),
        (ModuleNotFoundError("No module named 'trimesh'", name="trimesh"), 1, "needs the package 'trimesh'; pip install"),
        (KeyboardInterrupt(), 130, "radiosity: interrupted: "),
    ],
    ids=["device", "memory", "fault", "package", "interrupted"],
)
def test_other_failures(capsys, monkeypatch, error, status, text):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(rd.scene, "load_with_files", fail)
    found, _, err = run(capsys, "solve", "room")
    assert found == status
    assert text in err
    assert err.count("\n") == 1


@pytest.mark.filterwarnings("default:of a package")
def test_warnings_are_one_line_each_and_said_once(capsys):
    with app.tidy_warnings(debug=False):
        for text in ("two\n  lines", "two\n  lines", "another"):
            warnings.warn(text, rd.RadiosityWarning, stacklevel=1)
        warnings.warn("of a package", UserWarning, stacklevel=1)
    assert capsys.readouterr().err == "radiosity: warning: two lines\nradiosity: warning: another\n"


def test_version_and_help(capsys):
    assert run(capsys, "--version")[1].strip() == "0.1.0"
    status, out, err = run(capsys, "--help")
    assert status == 0
    assert err == ""
    commands = [line.split()[1] for line in out.splitlines() if line.startswith("│ ") and not line.startswith("│ -")]
    listed = [command for command in commands if command in app.app]
    assert listed == [
        "solve",
        "measure",
        "annual",
        "methods",
        "lines",
        "relight",
        "factors",
        "conductors",
        "exchange",
        "render",
        "view",
        "lightmap",
        "report",
        "compare",
        "convert",
        "check",
        "experiment",
        "doctor",
    ]


@pytest.mark.parametrize(
    "command", ["solve", "measure", "render", "view", "lightmap", "report", "compare", "convert", "check", "experiment", "doctor"]
)
def test_help_of_each_command_explains_each_option(capsys, command):
    status, out, _ = run(capsys, command, "--help")
    assert status == 0
    lines = [line.strip("│ ") for line in out.splitlines() if line.startswith("│ ")]
    options = [line for line in lines if line.startswith(("--", "*  --"))]
    assert all(len(line.split("  ", 1)) == 2 for line in options), options
    assert bool(options) == (command != "doctor")


def test_a_reader_that_closes_the_pipe_is_no_error():
    code = "import sys; from radiosity.cli import main; sys.exit(main(['check', 'room']))"
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    process.stdout.close()
    _, err = process.communicate()
    assert err == ""
    assert process.returncode == 1
