"""Long arrays are gone through in pieces: the same results, and little memory on the way."""

import tracemalloc

import numpy as np
import pytest

import radiosity as rd
from radiosity import pieces
from radiosity.solution.books import exact_totals
from radiosity.solution.errors import mean_and_error

LENGTHS = [1, 2, 3, 6, 7, 100]


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(pieces, "PIECE", 3)


@pytest.mark.parametrize("count", [0, *LENGTHS])
def test_pieces_hold_every_entry_once(small, count):
    parts = list(pieces.pieces(count))
    assert np.concatenate([np.arange(count)[part] for part in parts] or [[]]).tolist() == list(range(count))
    assert all(0 < part.stop - part.start <= 3 for part in parts)


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("dtype", [np.uint32, np.uint64])
def test_totals_are_those_of_whole_numbers(small, random, dtype, length):
    """With sums and products that 64 bits do not hold."""
    rows = random.integers(0, np.iinfo(dtype).max, (5, length), dtype, endpoint=True)
    weight = random.integers(0, 2**32, length, np.uint32)
    whole = [[int(value) for value in row] for row in rows]
    weighted = sum(value * int(w) for row in whole for value, w in zip(row, weight, strict=True))
    assert exact_totals(rows, weight) == (sum(map(sum, whole)), weighted)


@pytest.mark.parametrize("shape", [(4, 8), (4, 8, 3), (1, 8)])
def test_mean_and_error_are_those_of_the_whole(small, random, shape):
    values = random.random(shape)
    mean, error = mean_and_error(values)
    assert mean == pytest.approx(values.mean(axis=0), rel=1e-14)
    wanted = values.std(axis=0, ddof=1) / 2 if len(values) > 1 else np.full(shape[1:], np.nan)
    assert error == pytest.approx(wanted, rel=1e-12, nan_ok=True)


def solved(replicates: int):
    return rd.solve(
        rd.subdivide(rd.load_scene("cornell-box"), cells=3), "random-walk", quanta=4096, replicates=replicates, seed=3
    )


@pytest.mark.parametrize("replicates", [1, 4])
def test_the_size_of_pieces_is_not_seen_in_a_solution(monkeypatch, replicates):
    one = solved(replicates)
    monkeypatch.setattr(pieces, "PIECE", 37)
    other = solved(replicates)
    assert np.array_equal(one.irradiance, other.irradiance)
    assert one.books == other.books
    assert one.irradiance_standard_error == pytest.approx(other.irradiance_standard_error, rel=1e-12, nan_ok=True)
    assert one.error == pytest.approx(other.error, rel=1e-12, nan_ok=True)
    for first, second in zip(one.interval(), other.interval(), strict=True):
        assert first == pytest.approx(second, rel=1e-9, nan_ok=True)


@pytest.mark.parametrize(("name", "cells", "replicates", "most"), [("room", 118, 1, 65), ("cornell-box", 107, 8, 115)])
def test_reading_results_takes_little_more_memory_than_they_do(name, cells, replicates, most):
    """Bytes a patch, of NumPy's arrays alone, results included: 51 and 98; without pieces 93 and 162."""
    patches = rd.subdivide(rd.load_scene(name), cells=cells)
    assert len(patches) > 200_000
    rd.solve(patches, "random-walk", quanta=1 << 15, replicates=replicates)  # what patches keep
    tracemalloc.start()
    try:
        rd.solve(patches, "random-walk", quanta=1 << 15, replicates=replicates)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak / len(patches) < most
