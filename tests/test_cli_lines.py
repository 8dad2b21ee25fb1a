"""``radiosity lines`` and ``radiosity relight``, on small scenes: what they write is what the library makes."""

import numpy as np
import pytest
from command_line import run

import radiosity as rd
from radiosity.cli import main
from radiosity.cli.lines import _sources
from radiosity.cli.relight import _values

SMALL = ("--cells", "1", "--quanta", "3000", "--replicates", "2")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    path = tmp_path_factory.mktemp("lines") / "room.npz"
    assert main(["lines", "room", *SMALL, "--sources", "light:front", "-o", str(path)]) == 0
    return path


@pytest.fixture(scope="module")
def room():
    return rd.subdivide(rd.load_scene("room"), cells=1)


def test_lines_are_those_of_the_library(capsys, tmp_path, room, written):
    expected = rd.trace_lines(room, quanta=3000, replicates=2, sources={"light": "front"})
    found = rd.load_lines(written)
    assert np.array_equal(found.pairs.keys, expected.pairs.keys)
    assert np.array_equal(found.pairs.counts, expected.pairs.counts)
    choices = ("--seed", "3", "--first-replicate", "4", "--numbers", "sobol", "--one-way", "--sources", "light", "low*")
    status, out, err = run(capsys, "lines", "room", *SMALL, *choices, "-o", tmp_path / "a.npz")
    assert (status, err) == (0, "")
    assert out.splitlines()[-1] == f"wrote {tmp_path / 'a.npz'}"
    assert "seed 3 replicates 4 to 5" in out
    found = rd.load_lines(tmp_path / "a.npz")
    given = {"seed": 3, "first_replicate": 4, "numbers": "sobol", "both_ways": False, "sources": ["light", "low*"]}
    expected = rd.trace_lines(room, quanta=3000, replicates=2, **given)
    assert np.array_equal(found.pairs.counts, expected.pairs.counts)
    assert (found.sources, found.both_ways) == (("light", "low box"), False)


def test_lines_go_on_to_the_bits_of_one_run(capsys, tmp_path, room, written):
    more = ("lines", "room", "--quanta", "5000", "--replicates", "2", "--sources", "light:front", "--resume", written)
    assert run(capsys, *more, "-o", tmp_path / "b.npz")[::2] == (0, "")  # cut as the lines to continue
    expected = rd.trace_lines(room, quanta=5000, replicates=2, sources={"light": "front"})
    assert np.array_equal(rd.load_lines(tmp_path / "b.npz").pairs.counts, expected.pairs.counts)


def test_relight_is_the_library(capsys, tmp_path, written):
    paths = [tmp_path / "a.npz", tmp_path / "a.csv"]
    changes = ("--set", "light.emission=10,20,30", "*box.reflectance=0.2", "--set", "tall box.reflectance=0.3", "--bands", *"abc")
    status, out, err = run(capsys, "relight", written, *changes, "-o", *paths)
    assert (status, err) == (0, "")
    assert out.splitlines()[-2:] == [f"wrote {path}" for path in paths]
    assert "status    complete" in out
    expected = rd.load_lines(written).solve(
        emission={"light": [10, 20, 30]}, reflectance={"low box": 0.2, "tall box": 0.3}, bands=["a", "b", "c"]
    )
    found = rd.load_solution(paths[0])
    assert np.array_equal(found.radiosity, expected.radiosity)
    assert found.bands == ("a", "b", "c")


def test_relight_adds_files_of_other_replicates(capsys, tmp_path, written):
    more = ("lines", "room", *SMALL, "--sources", "light:front", "--first-replicate", "2", "-o", tmp_path / "more.npz")
    assert run(capsys, *more)[0] == 0
    assert run(capsys, "relight", written, tmp_path / "more.npz", "-o", tmp_path / "a.npz")[::2] == (0, "")
    found = rd.load_solution(tmp_path / "a.npz")
    parts = [rd.load_lines(path) for path in (written, tmp_path / "more.npz")]
    assert np.array_equal(found.irradiance_standard_error, (parts[0] + parts[1]).solve().irradiance_standard_error)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("relight", "LINES", "--set", "light.emision=3"), "'light.emision=3' is not understood; write NAME.emission=VALUE"),
        (("relight", "LINES", "--set", "emission=3"), "is not understood"),
        (("relight", "LINES", "--set", "light.emission"), "is not understood"),
        (("relight", "LINES", "--set", "light.emission=bright"), "'bright' is no number"),
        (("relight", "LINES", "--set", "light.emission="), "'' is no number"),
        (("relight", "LINES", "--set", "lamp.emission=3"), "no surface is called 'lamp'"),
        (("relight", "LINES", "--set", "light.emission=nan"), "is nan; it must be finite"),
        (("relight", "LINES", "--set", "light.reflectance=1"), "strictly below 1"),
        (("relight", "LINES", "--set", "light.emission=1,2", "floor.reflectance=0.1,0.2,0.3"), "has 2 bands, and there are 3"),
        (("relight", "LINES", "--set", "light.emission=0"), "no surface emits"),
        (("relight", "LINES", "LINES"), "overlap"),
        (("relight", "none.npz"), "none.npz: no such file"),
        (("relight", "LINES", "-o", "a.doc"), "unknown output format"),
        (("lines", "room", "-o", "a.csv"), "lines are written to an .npz file"),
        (("lines", "room"), "--output"),
        (("lines", "room", "-o", "a.npz", "--rays", "1k", "--seconds", "3"), "give exactly one of rays, seconds and quanta"),
        (("lines", "room", "-o", "a.npz", "--sources", "lamp"), "no surface is called 'lamp'"),
        (("lines", "room", "-o", "a.npz", "--sources", ":front"), "it names no surface"),
        (("lines", "room", "-o", "a.npz", "--lines", "curved"), "lines 'curved' does not exist"),
        (("lines", "room", "-o", "a.npz", "--resume", "none.npz"), "none.npz: no such file"),
        (("solve", "room", "--resume", "LINES"), "holds a line set, not a solution"),
    ],
)
def test_wrong_input_is_one_line(capsys, tmp_path, monkeypatch, written, arguments, message):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, *(written if argument == "LINES" else argument for argument in arguments))
    assert (status, out) == (2, "")
    assert len(err.splitlines()) == 1
    assert message in err
    assert list(tmp_path.iterdir()) == []


def test_changes_are_read_from_the_right():
    """Names may have dots and equals signs; the last change of a surface counts, and comes last."""
    found = _values(("a.b=c.emission=1", "x.emission.front=2", "x.emission.back=3,4", "y.emission=1", "a.b=c.emission=5"))
    assert found == {"emission": {"x": {"front": [2], "back": [3, 4]}, "y": [1], "a.b=c": [5]}, "reflectance": None}
    assert list(found["emission"]) == ["x", "y", "a.b=c"]
    assert _values(("x.emission.front=2", "x.emission=3"))["emission"] == {"x": [3]}
    assert _sources(("a", "b:front", "c:d", "e:back")) == {"a": "both", "b": "front", "c:d": "both", "e": "back"}
    assert _sources(()) is None
