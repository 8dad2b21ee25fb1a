"""``radiosity conductors``: what it writes is what the library finds, and wrong inputs get one clear error."""

import csv

import pytest

import radiosity as rd
from radiosity.cli import main

GIVEN = ("--emissivity", "*=0.9", "floor=0.5", "--merge", "walls=*wall")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    path = tmp_path_factory.mktemp("lines") / "room.npz"
    rd.trace_lines(rd.subdivide(rd.load_scene("room"), cells=1), quanta=5000, replicates=2).save(path)
    return path


def run(capsys, *arguments):
    status = main(["conductors", *(str(argument) for argument in arguments)])
    out, err = capsys.readouterr()
    return status, out, err


def test_conductors_are_those_of_the_library(capsys, tmp_path, written):
    status, out, err = run(capsys, written, *GIVEN, "-o", tmp_path / "a.csv")
    assert (status, err) == (0, "")
    assert out.splitlines()[0].startswith("Gebhart factors between 7 groups: 'walls', ")
    assert out.splitlines()[-1] == f"wrote {tmp_path / 'a.csv'}"
    expected = rd.gebhart_factors(
        rd.load_lines(written), emissivity={"*": 0.9, "floor": 0.5}, group={"walls": ["*wall"]}
    ).conductors
    with open(tmp_path / "a.csv", newline="") as file:
        row = next(row for row in csv.DictReader(file) if (row["from"], row["to"]) == ("walls", "floor"))
    assert float(row["conductor m²"]) == pytest.approx(expected[0, 1], rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--emissivity", "floor=0.5"], "none is given for 'south wall'"),
        (["--emissivity", "*=2"], "it must be above 0 and at most 1"),
        (["--emissivity", "*"], "write NAME=VALUE"),
        (["--emissivity", "*=0.5", "-o", "a.npz"], "conductors are written to .csv files"),
        (["--emissivity", "*=0.5", "--merge", "walls"], "write NAME=SURFACE,SURFACE"),
    ],
)
def test_wrong_inputs_are_refused(capsys, written, arguments, told):
    status, out, err = run(capsys, written, *arguments)
    assert status == 2
    assert out == ""
    assert told in err
    assert len(err.splitlines()) == 1
