"""The skeleton of docs/skeletons works, so that what is copied from it does: exact values, stages, an interruption, books."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.merging import merge
from radiosity.problem.model import Problem
from radiosity.sampling.streams import Seed

LINES = 256  # a patch
FILE = Path(__file__).parents[1] / "docs" / "skeletons" / "algorithm.py"


@pytest.fixture(scope="module")
def skeleton():
    spec = spec_from_file_location("skeleton", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def made(skeleton, cube, geometry_of):
    """Makes a new process on a furnace: reflectance 1/2, emission 1/2, so that B = H = 1 where no face is left out."""
    method = rd.Baseline(factors="lines", samples=LINES)

    def make(faces=slice(None), seed=3, replicates=2):
        patches = rd.subdivide(rd.Scene.from_arrays(cube.vertices, cube.faces[faces], 0.5, 0.5), cells=2)
        return skeleton.Reflections(geometry_of(patches), Problem.of(patches), method, seed, replicates)

    return make


def silent(lines):
    pass


def test_power_is_that_of_the_series(made):
    """After N reflections a furnace has 1 - 2^-N of its power, whatever the form factors: lines that leave arrive."""
    process = made()
    for steps in (1, 2, 5):
        process.advance(steps, silent)
        values, unit = process.tally.irradiance(process.problem, process.capture(), 0)
        power = values.sum(axis=1) * unit / process.area.sum()
        assert power == pytest.approx(1 - 0.5**steps, rel=1e-9)


def test_it_ends_at_the_exact_value(made):
    process = made()
    process.advance(10_000, silent)
    state = process.capture()
    assert state.solved.done
    assert not state.unfinished
    assert process.steps < 50
    values, unit = process.tally.irradiance(process.problem, state, 0)
    assert (values * unit).mean(axis=0) / process.area == pytest.approx(1, abs=0.15)  # 256 lines a patch
    assert not np.array_equal(*values)  # replicates have lines of their own
    assert process.tally.lines(process.problem, state) == process.steps * 2 * 24 * LINES


def test_the_energy_balance_of_an_open_box_closes(made):
    process = made(slice(1, None))
    process.advance(10_000, silent)
    books = process.tally.books(process.problem, process.capture(), 0)
    assert books["escaped"] > 0.05 * books["emitted"]
    assert books["lost"] == 0
    assert books["absorbed"] + books["escaped"] == pytest.approx(books["emitted"], rel=1e-5)


def test_a_captured_state_stays_as_it_is(made):
    """The run that it was taken from goes on, and so does one that was restored from it."""
    process, other = made(), made()
    process.advance(1, silent)
    state = process.capture()
    kept = {name: value.copy() for name, value in state.arrays().items()}
    other.restore(state)
    for run in (process, other):
        run.advance(2, silent)
        assert all(np.array_equal(state.arrays()[name], value) for name, value in kept.items())


def test_an_interrupted_run_goes_on_to_the_same_bits(made):
    class Enough(Exception):
        pass

    def stop(lines):
        raise Enough

    whole, part, rest = made(), made(), made()
    whole.advance(4, silent)
    with pytest.raises(Enough):
        part.advance(4, stop)
    assert part.capture().unfinished
    rest.restore(part.capture())
    rest.advance(4, silent)
    found, wanted = rest.capture().arrays(), whole.capture().arrays()
    assert found.keys() == wanted.keys()
    for name, value in wanted.items():
        assert np.array_equal(value, found[name]), name


def test_parts_are_merged_to_the_bits_of_one_run(made):
    runs = [made(seed=Seed(3, first), replicates=count) for first, count in ((0, 3), (0, 2), (2, 1))]
    for run in runs:
        run.advance(4, silent)
    whole, *parts = (run.capture() for run in runs)
    merged = merge(parts)
    assert merged.sizes == whole.sizes
    for name, value in whole.arrays().items():
        assert np.array_equal(merged.arrays()[name], value), name


def test_a_state_of_another_size_is_refused(made):
    process = made()
    with pytest.raises(rd.MethodError, match="start anew"):
        process.read(process.capture().arrays() | {"unsent": np.zeros((1, 1, 1))}, process.sizes)
