"""Outputs of a command: one that fails takes none of the others with it, and the exit status tells."""

import os
import signal
import subprocess
import sys

import pytest
from command_line import run

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
