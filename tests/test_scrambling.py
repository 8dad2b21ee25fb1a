"""The scrambling of a sequence is a choice beside it; older names that hold both stay, and so do files."""

from dataclasses import replace

import numpy as np
import pytest
from members import accepted

import radiosity as rd
from radiosity.cli.app import run
from radiosity.method.scrambling import SCRAMBLINGS
from radiosity.sampling.numbers import NUMBERS, SCRAMBLED, name_of, parts_of

OLDER = {"scrambled-halton": ("halton", "permuted-digits"), "generalized-faure": ("faure", "linear")}
FILED = {  # of `Method(numbers="scrambled-halton")`, as files hold it since there are such files
    "equation": "discrete",
    "lines": "local",
    "order": "breadth-first",
    "numbers": "scrambled-halton",
    "randomisation": "by-patch",
    "estimator": "collision",
    "absorption": "auto",
    "first_shot": 0.0,
    "control_variate": False,
    "warm_up": False,
    "reconstruction": "patches",
    "coherent": False,
}


@pytest.fixture(scope="module")
def patches():
    return rd.subdivide(rd.load_scene("room"), cells=1)


def test_every_name_stands_for_one_sequence_and_scrambling():
    assert len({parts_of(name) for name in NUMBERS}) == len(NUMBERS)
    assert all(name_of(*parts_of(name)) == name for name in NUMBERS)
    assert {parts_of(name)[1] for name in NUMBERS} == set(SCRAMBLINGS)
    assert {parts_of(name)[0] for name in NUMBERS} == set(NUMBERS) - set(SCRAMBLED)
    assert SCRAMBLED == OLDER


@pytest.mark.parametrize("name", OLDER)
def test_an_older_name_is_a_sequence_and_a_scrambling(name):
    sequence, scrambling = OLDER[name]
    method, older = rd.Method(numbers=sequence, scrambling=scrambling), rd.Method(numbers=name)
    assert method == older == rd.Method(numbers=name, scrambling=scrambling)
    assert hash(method) == hash(older)
    assert (older.numbers, older.scrambling) == (sequence, scrambling)
    assert str(method) == f"discrete/local/breadth-first/{name}"
    assert method != rd.Method(numbers=sequence) == rd.Method(numbers=sequence, scrambling="none")
    assert rd.Method(**method.choices) == method == replace(rd.Method(), numbers=name)
    assert rd.Method().scrambling is None


def test_files_hold_what_they_held(patches):
    """Options that have come since are held beside these."""
    choices = rd.Method(numbers="halton", scrambling="permuted-digits").choices
    assert {name: choices[name] for name in FILED} == FILED
    assert {name: rd.Method().choices[name] for name in FILED} == FILED | {"numbers": "halton"}
    assert "scrambling" not in choices
    done = rd.solve(patches, quanta=10, replicates=2, numbers="halton", scrambling="permuted-digits")
    assert done.provenance["choices"] == choices
    assert done.provenance["method"] == "discrete/local/breadth-first/scrambled-halton"


def test_a_run_goes_on_from_a_file_of_either_name(patches, tmp_path):
    first = rd.solve(patches, quanta=100, replicates=2, numbers="scrambled-halton")
    first.save(tmp_path / "a.npz")
    before = rd.load_solution(tmp_path / "a.npz")
    one = rd.solve(patches, quanta=300, replicates=2, numbers="halton", scrambling="permuted-digits", resume=before)
    other = rd.solve(patches, quanta=300, replicates=2, numbers="scrambled-halton")
    assert np.array_equal(one.irradiance, other.irradiance)
    with pytest.raises(rd.MethodError, match="numbers \\(scrambled-halton then, halton now\\)"):
        rd.solve(patches, "random-walk", quanta=300, replicates=2, resume=before)


@pytest.mark.parametrize(
    ("numbers", "scrambling", "reason"),
    [
        ("sobol", "linear", "'linear' is not for numbers 'sobol', which take none; it is for faure"),
        ("random", "permuted-digits", "not for numbers 'random', which take none; it is for halton"),
        ("halton", "linear", "which take none, permuted-digits; it is for faure"),
        ("scrambled-halton", "none", "'scrambled-halton' are halton with scrambling 'permuted-digits', not 'none'"),
        ("scrambled-halton", "linear", "take numbers 'halton', or leave scrambling out"),
        ("halton", "owen", "'owen' does not exist; known are none, permuted-digits, linear"),
        ("halton", "", "known are none"),
    ],
)
def test_what_does_not_exist_is_refused_with_the_reason(numbers, scrambling, reason):
    with pytest.raises(rd.MethodError, match=reason):
        rd.Method(numbers=numbers, scrambling=scrambling)


def test_another_sequence_drops_the_scrambling_of_the_one_that_it_replaces():
    older = rd.Method(numbers="scrambled-halton")
    assert rd.method.resolve(older, numbers="sobol") == rd.Method(numbers="sobol")
    assert rd.method.resolve(older, numbers="halton") == rd.Method()
    assert rd.method.resolve(older, scrambling="none") == rd.Method()
    assert rd.method.resolve(older, order="staged") == replace(older, order="staged")
    assert rd.method.resolve(scrambling="permuted-digits") == older
    assert rd.method.resolve(rd.Method(), numbers="faure", scrambling="linear") == rd.Method(numbers="generalized-faure")
    with pytest.raises(rd.MethodError, match="not for numbers 'sobol'"):
        replace(older, numbers="sobol")
    with pytest.raises(rd.MethodError, match="coherent firing needs strata of the Halton sequence"):
        replace(older, coherent=True)


PLAINEST = {method.machine: method for method in reversed(accepted())}


@pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of few lines
@pytest.mark.parametrize("name", PLAINEST)
def test_every_kind_of_run_takes_the_scrambling(patches, name):
    """A run that forgot it would have the bits of the sequence alone."""
    method = PLAINEST[name]
    few = {"quanta": 2000, "replicates": 1, "seed": 3}
    plain = rd.solve(patches, method, **few)
    scrambled = rd.solve(patches, method, scrambling="permuted-digits", **few)
    assert not np.array_equal(plain.irradiance, scrambled.irradiance)
    assert np.array_equal(scrambled.irradiance, rd.solve(patches, method, numbers="scrambled-halton", **few).irradiance)


@pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of few lines
def test_a_first_shot_takes_the_scrambling(patches):
    method = rd.Method(lines="global", order="multipath", first_shot=0.9)
    methods = method, replace(method, numbers="scrambled-halton")
    runs = [rd.solve(patches, method, quanta=2000, replicates=1) for method in methods]
    assert not np.array_equal(*(run.state["shot_arrivals"] for run in runs))


def test_the_command_line_takes_it_and_explains_it(capsys, tmp_path):
    few = f"solve room --cells 1 --quanta 10 --replicates 2 -o {tmp_path / 'a.npz'}".split()
    assert run([*few, "--numbers", "halton", "--scrambling", "permuted-digits"]) == 0
    assert "breadth-first/scrambled-halton, seed 0" in capsys.readouterr().out
    assert run([*few, "--numbers", "sobol", "--scrambling", "linear"]) == 2
    assert "it is for faure" in capsys.readouterr().err
    assert run(["methods", "scrambling"]) == 0
    assert [row.split()[0] for row in capsys.readouterr().out.splitlines()] == list(SCRAMBLINGS)
    assert run(["methods", "numbers"]) == 0
    told = capsys.readouterr().out
    for sequence, scrambling in OLDER.values():
        assert f"The same as --numbers {sequence} --scrambling {scrambling}." in told
