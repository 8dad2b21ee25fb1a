"""Sums of states: whole numbers of any size are added exactly, with their upper words."""

from itertools import pairwise

import numpy as np
import pytest

from radiosity.algorithms.adding import added
from radiosity.algorithms.state import Sizes
from radiosity.algorithms.walks.state import WalkState
from radiosity.tally.shots import Shot, between

SIZES = Sizes(1, 2, 1)
LARGE = [2**64 - 1, 5]


def state(received: list[int], fired: int, arrivals: list[int]) -> WalkState:
    """Return sums of one replicate of two patches and one group."""
    upper = np.array([value >> 64 for value in received], np.uint32).reshape(1, 2, 1)
    return WalkState(
        sizes=SIZES,
        quanta=8,
        arrivals=np.array([arrivals], np.uint32),
        missed=np.array([[1], [2]], np.uint32),
        fired_power=np.array([fired % 2**64], np.uint64),
        fired_power_upper=np.array([fired >> 64], np.uint64) if fired >> 64 else None,
        received=np.array([value % 2**64 for value in received], np.uint64).reshape(1, 2, 1),
        received_missed=np.zeros((2, 1, 1), np.uint64),
        received_upper=upper if upper.any() else None,
    )


CASES = [([3, 4], [5, 6]), (LARGE, [7, 8]), ([3 << 64, 1], LARGE), ([1 << 65, 0], [1 << 64, 9])]


@pytest.mark.parametrize(("one", "other"), CASES)
def test_sums_are_exact(one, other):
    found = added(state(one, one[0], [1, 2**32 - 1]), state(other, other[0], [3, 1]))
    total = [found.exact("received", (0, row, 0)) for row in range(2)]
    assert total == [a + b for a, b in zip(one, other, strict=True)]
    assert found.fired_in_all == [one[0] + other[0]]
    assert found.arrivals.tolist() == [[4, 2**32]]
    assert found.arrivals.dtype == np.uint64
    assert found.missed.tolist() == [[2], [4]]
    assert found.missed.dtype == np.uint32


def test_ranges_of_lines_are_all_lines_once():
    counts, shares = np.array([3, 0, 5, 1], np.uint32), [0, 2, 4, 4, 9]
    shot = Shot(0, np.arange(4, dtype=np.uint32), np.full(4, 10, np.uint32), counts, np.arange(4.0)[:, None])
    lines = []
    for low, high in pairwise(shares):
        part = shot.between(low, high)
        assert part.total == high - low
        assert part.weights.ravel().tolist() == part.numbers.tolist()
        rows = zip(part.numbers, part.fired, part.counts, strict=True)
        lines += [(row, at) for row, fired, more in rows for at in range(fired, fired + more)]
    assert sorted(lines) == [(row, 10 + at) for row, count in enumerate(counts) for at in range(count)]
    assert between(counts, 3, 3)[0].size == 0
