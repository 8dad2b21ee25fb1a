"""Outputs that cannot be written are found early, and no half file is left behind."""

import errno
import subprocess
import sys
from pathlib import Path

import pytest
from image_samples import quad_scene, solution

import radiosity as rd
from radiosity.image import check_writable, export, output, ply
from radiosity.solution.replacing import replacing

SUFFIXES = [".npz", ".glb", ".ply", ".vtp", ".csv", ".png", ".exr"]


@pytest.fixture
def result():
    return solution(rd.subdivide(quad_scene(), cells=2))


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_writable_outputs_leave_no_trace(tmp_path, suffix):
    assert check_writable(tmp_path / f"a{suffix.upper()}") == tmp_path / f"a{suffix.upper()}"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.docx", r"unknown output format '\.docx'; known are \.npz, \.glb, \.ply, \.vtp, \.csv, \.png, \.exr"),
        ("a", "unknown output format ''"),
        ("file/a.glb", "is a file, not a folder; choose another place$"),
        ("folder.glb", "is a folder; name a file in it$"),
        ("x" * 300 + ".glb", "cannot write there"),
        ("nul\0.glb", "cannot write there"),
    ],
)
def test_impossible_outputs_are_refused_before_a_run(tmp_path, result, name, message):
    (tmp_path / "folder.glb").mkdir()
    (tmp_path / "file").write_text("")
    for attempt in (check_writable, lambda path: export(result, path)):
        with pytest.raises(rd.OutputError, match=message):
            attempt(tmp_path / name)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file", "folder.glb"]


def test_a_folder_that_refuses_files_is_found(tmp_path, monkeypatch):
    def refuse(self, *args, **options):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(rd.OutputError, match="Permission denied"):
        check_writable(tmp_path / "a.glb")


def test_a_read_only_file_is_not_replaced(tmp_path, monkeypatch):
    (tmp_path / "a.glb").write_text("mine")
    monkeypatch.setattr(output.os, "access", lambda path, mode: False)  # the superuser may write anything
    with pytest.raises(rd.OutputError, match="read-only"):
        check_writable(tmp_path / "a.glb")


def test_the_table_of_surfaces_is_checked_too(tmp_path):
    (tmp_path / "a.surfaces.csv").mkdir()
    with pytest.raises(rd.OutputError, match=r"a\.surfaces\.csv: is a folder"):
        check_writable(tmp_path / "a.csv")


def test_a_missing_library_is_found_before_a_run(tmp_path, monkeypatch):
    monkeypatch.setattr(output, "find_spec", lambda name: None)
    with pytest.raises(rd.OutputError, match=r"needs 'PIL'.*pip install"):
        check_writable(tmp_path / "a.png")


def test_a_full_disk_leaves_the_old_file_and_no_other(tmp_path, result, monkeypatch):
    (tmp_path / "a.ply").write_text("old")

    def full(values):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(ply.tone, "eight_bits", full)  # called while the file is being written
    with pytest.raises(rd.OutputError, match="No space left on device"):
        export(result, tmp_path / "a.ply")
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("a.ply", "old")]


def test_other_faults_pass_and_leave_nothing(tmp_path):
    def fail():
        with replacing(tmp_path / "a.ply") as temporary:
            temporary.write_text("half")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert not list(tmp_path.iterdir())


def test_links_are_followed(tmp_path, result):
    (tmp_path / "real").mkdir()
    (tmp_path / "a.ply").symlink_to(tmp_path / "real" / "b.ply")
    export(result, tmp_path / "a.ply")
    assert (tmp_path / "a.ply").is_symlink()
    assert (tmp_path / "real" / "b.ply").read_bytes().startswith(b"ply")


def test_npz_is_left_to_the_solution(tmp_path, result):
    result.save = lambda path: Path(path).write_text("saved")
    assert export(result, tmp_path / "a.npz").read_text() == "saved"


@pytest.mark.usefixtures("small_pictures")
def test_pictures_are_exported(tmp_path):
    cornell = rd.load_scene("cornell-box")
    export(solution(rd.subdivide(cornell, cells=1)), tmp_path / "a.png", smooth=False)
    export(solution(rd.subdivide(cornell, cells=1)), tmp_path / "a.exr", smooth=False)
    assert {p.name: p.stat().st_size > 1000 for p in tmp_path.iterdir()} == {"a.png": True, "a.exr": True}


@pytest.mark.parametrize("first", ["radiosity.solution.loading", "radiosity.hooks"])
def test_a_solution_exports_in_a_process_that_did_not_import_the_exporters(tmp_path, first):
    """Its folder is below theirs, so it reaches them by a hook; importing any part of the package fills that."""
    rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), "random-walk", rays=10_000).save(tmp_path / "a.npz")
    code = (
        f"import sys, {first}\nfrom radiosity.solution.loading import load_solution\n"
        "solution = load_solution('a.npz')\nassert 'radiosity.image' not in sys.modules\n"
        "solution.export('a.csv')\nassert 'radiosity.image' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True)
    assert (tmp_path / "a.csv").is_file()
