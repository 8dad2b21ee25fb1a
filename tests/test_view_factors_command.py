"""``radiosity factors``: what it writes, prints and refuses."""

import csv
import subprocess
import sys

import numpy as np
import pytest
from command_line import run

import radiosity as rd


def test_a_process_of_its_own_writes_the_factors_of_the_library(tmp_path):
    outputs = [tmp_path / name for name in ("f.csv", "f.npz")]
    command = [sys.executable, "-m", "radiosity", "factors", "room", "--rays", "50k", "--seed", "3", "-o", *outputs]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "restored by least squares" in done.stdout
    assert "radiosity: " not in done.stdout
    expected = rd.view_factors(rd.load_scene("room"), rays=50_000, seed=3).restored()
    assert np.array_equal(rd.load_view_factors(outputs[1]).values, expected.values)
    with outputs[0].open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert np.array_equal(np.array([row[2 : 2 + len(expected)] for row in rows[1:]], float), expected.matrix)


def test_merged_raw_long_and_patches(capsys, tmp_path):
    few = ["--rays", "20k", "--method", "lines"]
    status, out, _ = run(capsys, "factors", "room", *few, "--merge", "walls=*wall", "boxes=low box,tall box", "--raw")
    assert status == 0
    assert "as measured" in out
    header = next(line for line in out.splitlines() if "escaped" in line and "lost" in line and "walls" in line)
    assert header.split()[:2] == ["walls", "boxes"]
    status, out, _ = run(
        capsys, "factors", "room", *few, "--group", "patch", "--cells", "1", "--layout", "long", "-o", tmp_path / "f.csv"
    )
    assert (status, (tmp_path / "f.csv").read_text(encoding="utf-8").splitlines()[0]) == (
        0,
        "from,to,area m²,view factor,standard error,lines",
    )


def test_an_energyplus_object_of_a_closed_room(capsys, tmp_path):
    status, _, err = run(capsys, "factors", "labyrinth", "--rays", "50k", "--zone", "Z", "-o", tmp_path / "f.idf")
    assert (status, err) == (0, "")
    assert (tmp_path / "f.idf").read_text(encoding="utf-8").splitlines()[
        2
    ] == "  Z,  !- Zone or ZoneList or Space or SpaceList Name"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["-o", "f.glb"], "unknown output format '.glb'; known are .csv, .npz, .idf"),
        (["-o", "f.csv", "f.csv"], "f.csv is named twice"),
        (["-o", "f.idf"], "give --zone NAME"),
        (["-o", "f.idf", "--zone", "z"], "closed"),
        (["--merge", "walls"], "write NAME=SURFACE,SURFACE"),
        (["--merge", "a=floor", "a=ceiling"], "--merge gives 'a' twice"),
        (["--merge", "a=flor"], "no surface is called 'flor'"),
        (["--merge", "a=floor", "--group", "patch"], "leave one of the two out"),
        (["--cells", "2", "--patch-size", "1"], "not both"),
        (["--sources", "sun"], "no surface is called 'sun'"),
    ],
)
def test_what_makes_no_sense_is_one_line(capsys, tmp_path, monkeypatch, arguments, told):
    monkeypatch.chdir(tmp_path)
    status, _, err = run(capsys, "factors", "room", "--rays", "20k", *arguments)
    assert status == 2
    assert err.startswith("radiosity: error: ")
    assert err.count("\n") == 1
    assert told in err
    assert not list(tmp_path.iterdir())


def test_an_interrupted_run_keeps_the_factors_so_far(monkeypatch):
    """Ctrl-C while lines are counted: the lines of the stages that are complete are factors, and say so."""
    import signal

    count = 0

    def interrupt(progress):
        nonlocal count
        count += 1
        if count == 4:
            signal.raise_signal(signal.SIGINT)

    found = rd.view_factors(rd.load_scene("room"), rays=30_000_000, method="lines", progress=interrupt)
    assert found.status == "interrupted"
    assert found.rays < 25_000_000
    assert np.abs(found.row_sums - 1).max() < 1e-12
