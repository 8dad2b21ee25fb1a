"""The commands, run on small scenes."""

import os
import re
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from command_line import run

import radiosity as rd
from radiosity.cli import main, progress
from radiosity.cli.options import DeviceName
from radiosity.device import llvm
from radiosity.device.backend import VARIANTS
from radiosity.image import tables
from radiosity.run.progress import Progress

SMALL = ("--cells", "2", "--rays", "20k", "--replicates", "2")
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    path = tmp_path_factory.mktemp("solved") / "box.npz"
    assert main(["solve", "cornell-box", *SMALL, "-o", str(path)]) == 0
    return path


@pytest.mark.usefixtures("small_pictures")
def test_solve_writes_everything_at_once(capsys, tmp_path):
    paths = [tmp_path / f"box{suffix}" for suffix in (".npz", ".glb", ".ply", ".vtp", ".csv", ".png", ".exr")]
    status, out, err = run(capsys, "solve", "cornell-box", *SMALL, "-o", *paths[:3], "-o", *paths[3:])
    assert status == 0
    assert err == ""
    assert out.splitlines()[-7:] == [f"wrote {path}" for path in paths]
    assert all(path.stat().st_size > 100 for path in paths)
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    assert f"cornell-box: {patches.scene.n_faces} faces, {len(patches.scene.names)} surfaces, {len(patches)} patches" in out
    assert "status    complete" in out


def test_solve_is_the_library(solved):
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    expected = rd.solve(patches, rays=20_000, replicates=2)
    found = rd.load_solution(solved)
    assert (found.arrivals == expected.arrivals).all()
    assert (found.radiosity == expected.radiosity).all()
    assert found.quanta == expected.quanta


def test_options_reach_the_library(capsys, tmp_path):
    path = tmp_path / "room.npz"
    sizes = ("--patch-size", "1m", "--quanta", "3k", "--replicates", "3", "--seed", "7")
    run(capsys, "solve", "room", *sizes, "--order", "depth-first", "--numbers", "random", "-o", path)
    found = rd.load_solution(path)
    expected = rd.solve(
        rd.subdivide(rd.load_scene("room"), size=1.0), quanta=3000, replicates=3, seed=7, order="depth-first", numbers="random"
    )
    assert (found.quanta, found.replicates) == (3000, 3)
    assert (found.radiosity == expected.radiosity).all()
    assert found.provenance["choices"]["numbers"] == "random"
    assert found.provenance["choices"]["order"] == "depth-first"


def test_numbers_of_replicates_and_seeds_are_written_as_rays_are(capsys, tmp_path):
    few = ("--cells", "1", "--quanta", "10", "-o", tmp_path / "room.npz")
    assert run(capsys, "solve", "room", *few, "--replicates", "2e1", "--seed", "9007199254740993")[0] == 0
    found = rd.load_solution(tmp_path / "room.npz")
    assert found.replicates == 20
    assert found.provenance["seed"] == 9007199254740993  # no double
    assert run(capsys, "solve", "room", *few, "--seed", "1k")[0] == 0
    assert rd.load_solution(tmp_path / "room.npz").provenance["seed"] == 1000


def test_the_command_line_knows_the_devices():
    assert get_args(DeviceName) == ("auto", *VARIANTS)


def test_resume(capsys, tmp_path):
    first, then = tmp_path / "a.npz", tmp_path / "b.npz"
    assert run(capsys, "solve", "room", "--patch-size", "50cm", "--rays", "300k", "-o", first)[0] == 0
    status, out, err = run(capsys, "solve", "room", "--resume", first, "--rays", "1M", "-o", then)
    assert (status, err) == (0, "")
    assert "status    complete" in out
    before, after = rd.load_solution(first), rd.load_solution(then)
    assert before.rays < after.rays
    assert after.rays == pytest.approx(1e6, rel=0.1)
    assert len(after.patches) == len(before.patches)
    whole = rd.solve(rd.subdivide(rd.load_scene("room"), size=0.5), quanta=after.quanta)
    assert (after.arrivals == whole.arrivals).all()
    assert (after.radiosity == whole.radiosity).all()


@pytest.mark.parametrize("options", [("labyrinth",), ("room", "--cells", "1"), ("room", "--seed", "1")], ids=" ".join)
def test_resume_refuses_another_run(capsys, tmp_path, options):
    first = tmp_path / "a.npz"
    assert run(capsys, "solve", "room", *SMALL, "-o", first)[0] == 0
    status, out, err = run(capsys, "solve", *options, "--replicates", "2", "--resume", first, "--rays", "40k")
    assert (status, out) == (2, "")
    assert err.startswith("radiosity: error: cannot go on from ")
    assert err.count("\n") == 1


@pytest.mark.parametrize("content", [b"no archive", b""], ids=["text", "empty"])
def test_what_is_no_solution_is_said_in_our_words(capsys, tmp_path, content):
    (tmp_path / "a.npz").write_bytes(content)
    status, _, err = run(capsys, "render", tmp_path / "a.npz", "-o", tmp_path / "a.png")
    assert status == 2
    assert err.startswith(f"radiosity: error: {tmp_path / 'a.npz'}: is no solution of this program, or damaged (")
    assert err.endswith("; solve the scene again\n")
    assert err.count("\n") == 1


def test_one_colour_bound_reaches_the_reader(capsys, tmp_path):
    (tmp_path / "white.mtl").write_text("newmtl white\nKd 1 1 1\nKe 1 1 1\n")
    (tmp_path / "white.obj").write_text("mtllib white.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl white\nf 1 2 3\n")
    status, _, err = run(
        capsys, "solve", tmp_path / "white.obj", *SMALL, "--max-reflectance", "0.8", "-o", tmp_path / "white.npz"
    )
    assert status == 0
    assert re.search(r"^radiosity: warning: .*reflectance above 0\.8 brought down", err)
    assert rd.load_solution(tmp_path / "white.npz").patches.reflectance.max() == 0.8


def test_no_light_is_wrong_input(capsys, tmp_path):
    (tmp_path / "dark.obj").write_text(TRIANGLE)
    status, _, err = run(capsys, "solve", tmp_path / "dark.obj", *SMALL)
    assert status == 2
    errors = [line for line in err.splitlines() if line.startswith("radiosity: error: ")]
    assert len(errors) == 1
    assert "emi" in errors[0]


def test_interrupted_runs_write_what_is_there(capsys, monkeypatch, tmp_path):
    @contextmanager
    def impatient():
        def listen(state):
            if state.stage >= 1:
                os.kill(os.getpid(), signal.SIGINT)

        yield listen

    monkeypatch.setattr(progress, "bar", impatient)
    status, out, _ = run(
        capsys, "solve", "room", "--cells", "1", "--rays", "1G", "-o", tmp_path / "room.npz", tmp_path / "room.csv"
    )
    assert status == 130
    assert "status    interrupted" in out
    found = rd.load_solution(tmp_path / "room.npz")
    assert found.status == "interrupted"
    assert 0 < found.rays < 10**9
    assert (tmp_path / "room.csv").exists()


def test_one_failing_output_does_not_take_the_others_along(capsys, monkeypatch, tmp_path):
    def fail(*_):
        raise OSError("the disk is full")

    monkeypatch.setattr(tables, "write", fail)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    status, out, err = run(capsys, "solve", "room", *SMALL, "-o", tmp_path / "a.csv", tmp_path / "a.ply")
    assert status == 2
    assert f"wrote {tmp_path / 'a.ply'}" in out
    assert err.startswith("radiosity: error: ")
    assert "the disk is full" in err
    kept = Path(re.search(r"kept in (\S+)", err).group(1))
    assert rd.load_solution(kept).rays > 0
    kept.unlink()
    status, _, err = run(capsys, "solve", "room", *SMALL, "-o", tmp_path / "a.csv", tmp_path / "a.npz")
    assert status == 2
    assert "kept in" not in err


@pytest.fixture
def places(tmp_path):
    """A folder with names for others in it: ``sub``, a link to it, and links to files that are not there yet."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "also").symlink_to("sub", target_is_directory=True)
    (tmp_path / "link.npz").symlink_to("a.npz")
    (tmp_path / "link.png").symlink_to(tmp_path / "sub" / "b.png")
    return tmp_path


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("a.npz", "a.npz"),
        ("a.npz", "sub/../a.npz"),
        ("a.npz", "./sub/.././a.npz"),
        ("a.npz", "also/../a.npz"),
        ("sub/a.glb", "also/a.glb"),
        ("a.npz", "link.npz"),
        ("sub/../link.npz", "a.npz"),
        ("link.png", "also/b.png"),
        ("a.csv", "a.surfaces.csv"),  # the table of surfaces lies beside that of patches
        ("sub/a.surfaces.csv", "also/a.csv"),
    ],
)
@pytest.mark.parametrize("absolute", [False, True])
def test_one_file_under_two_names_is_refused_before_the_run(capsys, monkeypatch, places, one, other, absolute):
    monkeypatch.chdir(places)
    monkeypatch.setattr(rd.scene, "load_with_files", lambda *_, **__: pytest.fail("it ran"))
    before = sorted(places.rglob("*"))
    second = places / other if absolute else other
    for more in ((), ("c.ply",)):
        status, out, err = run(capsys, "solve", "cornell-box", *SMALL, "-o", one, *more, "-o", second)
        assert (status, out) == (2, "")
        named = re.escape(str(Path(second)))
        assert re.match(rf"radiosity: error: {named} is named twice.*; give each output its own name\n", err)
    assert sorted(places.rglob("*")) == before


@pytest.mark.parametrize(("one", "other"), [("a.png", "sub/../a.png"), ("link.png", "also/b.png")])
def test_one_picture_under_two_names_is_refused(capsys, monkeypatch, places, solved, one, other):
    monkeypatch.chdir(places)
    status, _, err = run(capsys, "render", solved, "-o", one, other)
    assert status == 2
    assert f"{other} is named twice" in err
    assert [path.name for path in places.rglob("*.png")] == ["link.png"]


@pytest.mark.parametrize(
    ("output", "checkpoint"), [("a.npz", "sub/../a.npz"), ("a.npz", "link.npz"), ("also/a.npz", "sub/a.npz")]
)
def test_a_checkpoint_that_is_an_output_is_refused(capsys, monkeypatch, places, output, checkpoint):
    monkeypatch.chdir(places)
    status, _, err = run(capsys, "solve", "cornell-box", *SMALL, "-o", output, "--checkpoint", checkpoint)
    assert status == 2
    assert "is named twice; give the checkpoint a name of its own" in err


def test_other_files_of_like_names_are_no_doubles(capsys, monkeypatch, places):
    monkeypatch.chdir(places)
    names = ("a.csv", "b.csv", "sub/a.csv", "sub/a.npz", "a.npz")
    assert run(capsys, "solve", "cornell-box", *SMALL, "-o", *names)[0] == 0
    for name in (*names, "a.surfaces.csv", "b.surfaces.csv", "sub/a.surfaces.csv"):
        assert (places / name).stat().st_size > 100


def test_render(capsys, solved, tmp_path):
    from PIL import Image

    status, out, err = run(
        capsys, "render", solved, "-o", tmp_path / "view.png", tmp_path / "view.exr", "--width", "64", "--height", "48"
    )
    assert (status, err) == (0, "")
    assert out == f"wrote {tmp_path / 'view.png'}\nwrote {tmp_path / 'view.exr'}\n"
    picture = np.asarray(Image.open(tmp_path / "view.png"))
    assert picture.shape == (48, 64, 3)
    assert picture.std() > 10
    own = (
        "--origin",
        "0.27,0.27,-0.5",
        "--target",
        "0.27,0.27,0.3",
        "--fov",
        "60",
        "--width",
        "64",
        "--no-smooth",
        "--exposure",
        "1",
    )
    assert run(capsys, "render", solved, "-o", tmp_path / "own.png", *own)[0] == 0
    assert np.asarray(Image.open(tmp_path / "own.png")).shape == (48, 64, 3)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (("--camera", "3"), "camera 3"),
        (("--camera", "0", "--origin", "0,0,0", "--target", "1,1,1"), "not both"),
        (("--origin", "0,0,0"), "go together"),
        (("--fov", "200"), "between 0 and 180"),
        (("--quantity", "sound"), "quantity 'sound' does not exist"),
        (("--band", "violet"), "violet"),
        (("--width", "0"), "width is 0; it must be a whole number of 1 or more"),
        (("--height", "0"), "height is 0; it must be a whole number of 1 or more"),
        (("--width", "-3"), "width is -3"),
        (("--exposure", "inf"), "'inf' is no exposure"),
    ],
)
def test_render_refuses(capsys, solved, tmp_path, options, text):
    status, _, err = run(capsys, "render", solved, "-o", tmp_path / "view.png", *options)
    assert status == 2
    assert text in err
    assert err.count("\n") == 1
    assert not (tmp_path / "view.png").exists()


def test_check_prints_what_there_is(capsys):
    status, out, err = run(capsys, "check", "cornell-box")
    assert (status, err) == (0, "")
    assert "extent    0.556 x 0.5488 x 0.5592 m" in out
    assert "faces     21: 10 triangles, 11 parallelograms" in out
    assert "emitters  1, 0.729 / 0.5146 / 0.1715 W in all" in out
    assert re.search(r"^left wall +2 +0\.3069 +0\.63 / 0\.065 / 0\.05 +- +- +one", out, re.MULTILINE)
    assert re.search(r"^warning leaks: .* out at the scene's lowest z 100 %", out, re.MULTILINE)
    rows = re.findall(r"^(.{11}?) +\d+ +([\d.]+) .* (?:one|two) *$", out, re.MULTILINE)
    assert rows[0][0].strip() == "light"  # what emits, then by area
    assert [float(area) for _, area in rows[1:]] == sorted((float(area) for _, area in rows[1:]), reverse=True)
    assert len(rows) == 8


def test_check_of_a_file_that_cannot_be_read(capsys, tmp_path):
    (tmp_path / "empty.obj").write_text("")
    status, out, err = run(capsys, "check", tmp_path / "empty.obj")
    assert (status, err) == (1, "")
    assert out == f"error file: {tmp_path / 'empty.obj'}: the file is empty\n"


def test_check_of_a_dark_scene_with_an_odd_name(capsys, tmp_path):
    (tmp_path / "dark.obj").write_text("o [red]brick[/red]\n" + TRIANGLE)
    status, out, _ = run(capsys, "check", tmp_path / "dark.obj")
    assert status == 1
    assert "error no light: " in out
    assert "[red]brick[/red]" in out


def test_doctor_finds_this_machine_well(capsys):
    status, out, err = run(capsys, "doctor")
    assert (status, err) == (0, "")
    states = {line.split()[1]: line.split()[0] for line in out.splitlines()}
    assert states["solver"] == "ok"
    assert states["LLVM"] == "ok"
    assert "problem" not in states.values()
    (library,) = [line for line in out.splitlines() if line.split()[1] == "LLVM"]
    assert library.endswith(f", {llvm.find().origin})")


def test_doctor_names_a_bad_llvm(tmp_path):
    environment = {**os.environ, "DRJIT_LIBLLVM_PATH": str(tmp_path / "libLLVM.so")}
    found = subprocess.run(
        [sys.executable, "-m", "radiosity", "doctor"], env=environment, capture_output=True, text=True, check=False
    )
    assert found.returncode == 1
    (problem,) = [line for line in found.stdout.splitlines() if line.startswith("problem")]
    assert str(tmp_path / "libLLVM.so") in problem
    assert "DRJIT_LIBLLVM_PATH" in problem
    solve = [sys.executable, "-m", "radiosity", "solve", "room", "--rays", "1k"]
    found = subprocess.run(solve, env=environment, capture_output=True, text=True, check=False)
    assert found.returncode == 1
    assert "Traceback" not in found.stderr  # Dr.Jit itself says a line or two before ours
    assert found.stderr.splitlines()[-1].startswith(f"radiosity: error: DRJIT_LIBLLVM_PATH names {tmp_path / 'libLLVM.so'}")


@pytest.mark.parametrize("command", [("check", "room"), ("solve", "room", *SMALL), ("solve", "--help")], ids=" ".join)
def test_terminals_without_superscripts(command):
    """Each in a process of its own: what writes the help keeps the terminal that it has seen first."""
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    found = subprocess.run([sys.executable, "-m", "radiosity", *command], env=environment, capture_output=True, check=False)
    assert found.returncode == 0
    assert found.stderr == b""
    assert found.stdout
    assert found.stdout.isascii()


def test_progress_line():
    state = Progress(2, 12_300_000, 21.4e6, 0.0123, 0.5, 185.0, "tracing")
    assert progress.facts(state) == "stage 3, 12.3M rays, 21.4M/s, error 1.2 %, 3 min 05 s left"
    state = Progress(0, 0, 0.0, float("nan"), None, None, "compiling")
    assert progress.facts(state) == "stage 1, 0 rays, 0/s"
    told = ["0 s", "59 s", "1 min 00 s", "59 min 59 s", "2 h 10 min"]
    assert [progress.duration(s) for s in (-1, 59.4, 60, 3599, 7800)] == told


def test_no_progress_where_nobody_looks(capsys):
    with progress.bar() as advance:
        assert advance is None
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("full", "unbuffered"),
    [(False, ""), (True, "1"), pytest.param(False, "1", marks=pytest.mark.slow), pytest.param(True, "", marks=pytest.mark.slow)],
)
def test_outputs_are_written_where_nobody_reads_the_report(tmp_path, unbuffered, full):
    """Of a pipe whose reader has gone, and of a full disk."""
    if full and not Path("/dev/full").exists():
        pytest.skip("no /dev/full on this system")
    ours, theirs = os.pipe()
    os.close(ours)
    stdout = os.open("/dev/full", os.O_WRONLY) if full else os.dup(theirs)
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys; from radiosity.cli import main; sys.exit(main())",
            "solve",
            "room",
            "--cells",
            "1",
            "--quanta",
            "1k",
            "-o",
            "a.csv",
            "b.npz",
        ],
        cwd=tmp_path,
        env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
    )
    os.close(theirs)
    os.close(stdout)
    assert done.returncode == 0
    assert ("standard output cannot be written to" in done.stderr) == full
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "a.surfaces.csv", "b.npz"]
