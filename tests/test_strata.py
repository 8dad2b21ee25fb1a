"""Boxes of like directions, which coherent firing goes through one by one."""

import numpy as np
import pytest

from radiosity.sampling.numbers import strata


def radical_inverse(index: np.ndarray, base: int) -> np.ndarray:
    result, scale = np.zeros(len(index)), 1 / base
    while index.any():
        result, index, scale = result + index % base * scale, index // base, scale / base
    return result


@pytest.mark.parametrize("size", strata.SIZES)
class TestBoxes:
    def test_each_is_walked_once(self, size):
        assert sorted(strata.walk(*size)) == list(range(strata.boxes(*size)))

    def test_lines_of_a_box_are_alike(self, size, random):
        """Whatever cycle they are of."""
        n, walk = strata.boxes(*size), strata.walk(*size).astype(np.int64)
        cells = [2 ** size[0], 3 ** size[1]]
        place = {}
        for cycle in random.integers(0, 1000, 3):
            numbers = [radical_inverse(walk + cycle * n, base) for base in (2, 3)]
            place[cycle] = np.stack([np.floor(x * k + 1e-9) for x, k in zip(numbers, cells, strict=True)])
        first, *others = place.values()
        assert all(np.array_equal(first, other) for other in others)
        assert len(set(zip(*first.astype(int), strict=True))) == n

    def test_neighbours_in_the_walk_are_neighbours(self, size):
        walk = strata.walk(*size).astype(np.int64)
        place = np.stack([np.floor(radical_inverse(walk, b) * b**k + 1e-9) for b, k in zip((2, 3), size, strict=True)])
        assert (np.abs(np.diff(place)).sum(axis=0) == 1).all()

    def test_none_is_much_wider_or_higher(self, size):
        """Of directions 45 degrees off the normal: a full turn of the first number is 2 pi sin of that, the square of the sine
        grows at 2 sin cos."""
        across, up = 2 * np.pi * np.sqrt(0.5) / 2 ** size[0], 1 / 3 ** size[1]
        assert 1 / 4 < across / up < 4
