"""``radiosity methods`` and the choices of ``radiosity solve``."""

import pytest

import radiosity as rd
from radiosity.cli.app import run


def test_the_list_names_every_method(capsys):
    assert run(["methods"]) == 0
    out = capsys.readouterr().out
    rows = [line.split() for line in out.splitlines()]
    assert {row[0] for row in rows if row} >= set(rd.PRESETS | rd.BASELINES)
    assert next(row for row in rows if row and row[0] == "qmc-radiosity")[1:6] == [
        "continuous",
        "local",
        "breadth-first",
        "halton",
        "fractional",
    ]


@pytest.mark.parametrize("name", rd.PRESETS | rd.BASELINES)
def test_a_method_is_explained(name, capsys):
    assert run(["methods", name]) == 0
    out = capsys.readouterr().out
    assert out.startswith(f"{name}: {(rd.PRESETS | rd.BASELINES)[name].method}")
    assert (rd.PRESETS | rd.BASELINES)[name].source.bibtex in out


@pytest.mark.parametrize("axis", ["equation", "lines", "order", "numbers"])
def test_an_axis_is_explained(axis, capsys):
    from radiosity.method.model import AXES

    assert run(["methods", axis]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert [row.split()[0] for row in rows] == list(AXES[axis])
    assert all(len(row.split()) > 2 for row in rows)


def test_the_randomisation_is_explained_and_chosen(capsys):
    assert run(["methods", "randomisation"]) == 0
    assert [row.split()[0] for row in capsys.readouterr().out.splitlines()] == ["by-patch", "shared"]
    assert run(["solve", "room", "--rays", "200k", "--randomisation", "shared"]) == 0
    assert "breadth-first/halton/shared" in capsys.readouterr().out
    assert run(["solve", "room", "--rays", "200k", "--randomisation", "wild"]) == 2
    assert "known are by-patch, shared" in capsys.readouterr().err


def test_an_unknown_method_is_an_error_that_lists_them(capsys):
    assert run(["methods", "magic"]) == 2
    assert "known are auto, random-walk" in capsys.readouterr().err
    assert run(["solve", "room", "--method", "magic"]) == 2
    assert "known are auto, random-walk" in capsys.readouterr().err


def test_axes_are_options_of_solve(capsys):
    line = "solve room --rays 200k --equation continuous --lines local --order breadth-first --numbers sobol --estimator survival"
    assert run(line.split()) == 0
    assert "continuous/local/breadth-first/sobol/survival" in capsys.readouterr().out
    line = "solve room --rays 200k --method global-multipath --first-shot 20%"
    assert run(line.split()) == 0
    assert "first-shot=0.2" in capsys.readouterr().out


def test_a_senseless_combination_says_why(capsys):
    assert run(["solve", "room", "--rays", "1k", "--lines", "global"]) == 2
    assert "take multipath, matrix or regular" in capsys.readouterr().err
