"""Outputs of a command: one that fails takes none of the others with it, and the exit status tells."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest
from command_line import run
from samples import png

import radiosity as rd
from radiosity.image import bitmap, still
from radiosity.image import output as place

RUN = ("solve", "cornell-box", "--cells", "1", "--quanta", "64", "--replicates", "2")


@pytest.fixture
def after_solving(monkeypatch):
    """Something that happens while a run goes on."""

    def change(what):
        solve = rd.solve

        def solved(*arguments, **options):
            solution = solve(*arguments, **options)
            what()
            return solution

        monkeypatch.setattr(rd, "solve", solved)

    return change


def test_a_folder_that_has_gone_is_made_anew(capsys, tmp_path, after_solving):
    gone = tmp_path / "gone"
    gone.mkdir()
    after_solving(gone.rmdir)
    assert run(capsys, *RUN, "-o", gone / "a.csv")[0] == 0
    assert (gone / "a.csv").stat().st_size > 100


def test_a_file_in_place_of_a_folder_takes_its_own_files_alone(capsys, tmp_path, after_solving):
    gone = tmp_path / "gone"
    gone.mkdir()
    after_solving(lambda: (gone.rmdir(), gone.write_text("")))
    paths = [gone / "a.png", tmp_path / "b.glb", gone / "c.csv", tmp_path / "d.npz", tmp_path / "e.csv"]
    status, out, err = run(capsys, *RUN, "-o", *paths)
    assert status == 2
    assert [line for line in out.splitlines() if line.startswith("wrote")] == [f"wrote {paths[i]}" for i in (1, 3, 4)]
    assert all(path.stat().st_size > 100 for path in (paths[i] for i in (1, 3, 4)))
    assert err.count("\n") == 1
    assert str(paths[0]) in err
    assert str(paths[2]) in err
    assert "was kept" not in err  # there is an .npz


def test_a_library_that_is_missing_in_the_end(capsys, tmp_path, monkeypatch, after_solving):
    after_solving(lambda: monkeypatch.setattr(place, "find_spec", lambda name: None))
    status, _, err = run(capsys, *RUN, "-o", tmp_path / "a.png", tmp_path / "b.csv", tmp_path / "c.npz")
    assert status == 2
    assert "needs 'PIL'" in err
    assert (tmp_path / "b.csv").exists()
    assert rd.load_solution(tmp_path / "c.npz").quanta == 64


def test_a_report_that_fails_loses_no_file(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(rd.Solution, "report", lambda self: 1 / 0)
    status, out, err = run(capsys, *RUN, "-o", tmp_path / "c.npz")
    assert (status, out) == (2, f"wrote {tmp_path / 'c.npz'}\n")
    assert "the report: ZeroDivisionError" in err


def test_a_refine_check_whose_table_cannot_be_written(capsys, tmp_path, monkeypatch):
    check = rd.refine_check

    def checked(*arguments, **options):
        found = check(*arguments, **options)
        (tmp_path / "a.refine.csv").mkdir()
        return found

    monkeypatch.setattr(rd, "refine_check", checked)
    status, out, err = run(capsys, *RUN, "--refine-check", "-o", tmp_path / "a.csv", tmp_path / "b.npz")
    assert status == 2
    assert f"{tmp_path / 'a.refine.csv'}: " in err
    assert "refine check:" in out
    assert (tmp_path / "a.csv").exists()
    assert (tmp_path / "b.npz").exists()


def test_pictures_come_last(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(still, "write", lambda *_, **options: None)
    names = ("a.png", "b.glb", "c.exr", "d.npz")
    status, out, _ = run(capsys, *RUN, "-o", *(tmp_path / name for name in names))
    assert status == 0
    assert out.splitlines()[-4:] == [f"wrote {tmp_path / name}" for name in ("b.glb", "d.npz", "a.png", "c.exr")]


def test_even_a_picture_that_ends_the_process_leaves_the_rest(tmp_path):
    """As pictures of some scenes did."""
    code = "import os; from radiosity.cli import main; from radiosity.image import still; "
    code += "still.write = lambda *_, **__: os.abort(); main()"
    words = [*RUN, "-o", str(tmp_path / "a.png"), str(tmp_path / "b.npz"), str(tmp_path / "c.csv")]
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=False)
    assert done.returncode == -signal.SIGABRT
    assert sorted(os.listdir(tmp_path)) == ["b.npz", "c.csv", "c.surfaces.csv"]


def test_render_goes_on_after_a_picture_that_fails(capsys, tmp_path):
    solved = tmp_path / "a.npz"
    assert run(capsys, *RUN, "-o", solved)[0] == 0
    small = ("--width", "8", "--height", "8")
    status, out, err = run(capsys, "render", solved, "-o", tmp_path / "a.exr", tmp_path / "b.png", "--false-color", *small)
    assert (status, out) == (2, f"wrote {tmp_path / 'b.png'}\n")
    assert "a.exr: EXR holds physical values" in err
    assert (tmp_path / "b.png").exists()
    status, out, err = run(capsys, "render", solved, "-o", tmp_path / "c.png", tmp_path / "d.png", "--camera", "7", *small)
    assert (status, out) == (2, "")
    assert err.count("camera 7 does not exist") == 1  # said once


def test_a_fault_in_one_picture_is_told_as_one(capsys, tmp_path, monkeypatch):
    solved = tmp_path / "a.npz"
    assert run(capsys, *RUN, "-o", solved)[0] == 0
    monkeypatch.setattr(bitmap, "write_png", lambda *_: 1 / 0)
    status, _, err = run(capsys, "render", solved, "-o", tmp_path / "a.png", "--width", "8")
    assert status == 1
    assert "a fault of the program, not of your input: ZeroDivisionError" in err


@pytest.fixture(scope="module")
def read_files(tmp_path_factory):
    """A scene of several files, with an image, and what other commands read."""
    folder = tmp_path_factory.mktemp("read")
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    rd.save_scene(rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], reflectance=0.5, emission=1, names=["a"]), folder / "room.glb")
    (folder / "grey.png").write_bytes(png(np.full((2, 2, 3), 128)))
    (folder / "m.mtl").write_text("newmtl m\nmap_Kd grey.png\n")
    text = "mtllib m.mtl\nv 0 0 1\nv 1 0 1\nv 1 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n"
    (folder / "lid.obj").write_text(text)
    (folder / "room.toml").write_text('geometry = ["room.glb", "lid.obj"]\n[[surface]]\nname = "a*"\npower = 1\n')
    (folder / "p.csv").write_text("x,y,z\n0.5,0.5,0.5\n")
    rd.trace_lines(rd.subdivide(rd.load_scene(folder / "room.toml"), cells=1), quanta=2, replicates=1).save(folder / "lines.npz")
    (folder / "other.glb").symlink_to(folder / "room.glb")
    return folder


@pytest.mark.parametrize(
    ("command", "output"),
    [
        ("solve room.toml", "room.glb"),  # the geometry of the scene, by the name that one would give the result
        ("solve room.toml", "other.glb"),  # by another name
        ("solve lid.obj", "grey.png"),  # an image of a material
        ("solve room.glb --cells 1", "x.csv room.glb"),
        ("measure room.toml --points p.csv", "p.csv"),
        ("annual room.toml --points p.csv --epw p.csv", "p.csv"),
        ("factors lines.npz", "lines.npz"),
        ("exchange lines.npz", "lines.npz"),
        ("relight lines.npz", "lines.npz"),
        ("relight lines.npz x.npz", "m.npz lines.npz"),
        ("convert room.toml", "lid.obj"),
        ("convert lid.obj", "m.obj"),  # writes m.mtl beside it
    ],
)
def test_what_is_read_is_not_written_over(capsys, read_files, monkeypatch, command, output):
    monkeypatch.chdir(read_files)
    before = {path.name: path.read_bytes() for path in read_files.iterdir()}
    option = () if command.startswith("convert") else ("-o",)
    status, _, err = run(capsys, *command.split(), *option, *output.split())
    assert status == 2
    assert "is read, and would be written over; choose another name" in err or "(lid.obj is read)" in err
    assert {path.name: path.read_bytes() for path in read_files.iterdir()} == before


def test_a_run_is_gone_on_from_under_its_own_name(capsys, tmp_path):
    """A file that --resume reads may be written over: what it holds is in the new one."""
    assert run(capsys, *RUN, "-o", tmp_path / "a.npz")[0] == 0
    assert run(capsys, *RUN, "-o", tmp_path / "a.npz", "--resume", tmp_path / "a.npz")[0] == 0
