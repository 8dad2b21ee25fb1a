"""View factors of many groups, which are restored by scaling: the values of a plain formula, and little memory."""

import tracemalloc

import numpy as np
import pytest

from radiosity import pieces
from radiosity.exchange.restored_many import by_scaling
from radiosity.exchange.view_factors import ViewFactors


def counted(draw: np.random.Generator, n: int, each: int, *, missed: bool) -> ViewFactors:
    """Counts of lines between groups of two areas, with values and errors that need not belong to a scene."""
    codes = np.unique(np.repeat(np.arange(n), each) * (n + 2) + draw.integers(0, n + 2 * missed, n * each))
    rows, columns = np.divmod(codes, n + 2)
    hits = draw.integers(1, 9, len(codes))
    values = hits / np.bincount(rows, hits, n)[rows]
    area, line = 1 + np.arange(n) % 2, (1 + np.arange(n) % 3) / each
    names, errors = tuple(map(str, range(n))), values * draw.random(len(codes))
    return ViewFactors(names, area.astype(float), rows, columns, values, errors, 8, None, line, hits)


@pytest.mark.parametrize("missed", [False, True])
def test_errors_and_hits_are_of_both_directions(random, monkeypatch, missed):
    """The weighted mean of two independent directions; what is missed has one direction alone."""
    monkeypatch.setattr(pieces, "PIECE", 7)
    factors = counted(random, 9, 12, missed=missed)
    found = by_scaling(factors)
    assert np.abs(found.row_sums - 1).max() < 1e-12
    assert (np.diff(found.rows * 11 + found.columns) > 0).all()
    error, hits, values = np.zeros((3, 9, 11))
    for into, some in ((error, factors.errors), (hits, factors.hits), (values, factors.values)):
        into[factors.rows, factors.columns] = some
    area, weight = factors.area, 1 / (factors.line * factors.area)
    assert found.escaped * values[:, 10] == pytest.approx(found.lost * values[:, 9], rel=1e-12)  # scaled alike, with their row
    for i, j, own, count in zip(found.rows, found.columns, found.errors, found.hits, strict=True):
        if j >= 9 or i == j:
            assert (own, count) == (pytest.approx(error[i, j]), hits[i, j])
        else:
            both = np.hypot(weight[i] * area[i] * error[i, j], weight[j] * area[j] * error[j, i])
            assert own == pytest.approx(both / (weight[i] + weight[j]) / area[i])
            assert count == hits[i, j] + hits[j, i]


def test_restoring_takes_little_more_memory_than_its_result(random, monkeypatch):
    """Bytes of NumPy's arrays for each factor of the result, which is 40 of them: 53; without care 128."""
    monkeypatch.setattr(pieces, "PIECE", 1 << 12)
    factors = counted(random, 1500, 60, missed=False)
    tracemalloc.start()
    try:
        found = by_scaling(factors)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak / len(found.rows) < 65
