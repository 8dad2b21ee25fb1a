"""Boxes of like directions, which coherent firing goes through one by one."""

import numpy as np
import pytest

from radiosity.device.backend import choose, upload
from radiosity.sampling.numbers import strata
from radiosity.tracing.lanes import boxes_for


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

    def test_they_are_about_as_wide_as_high(self, size):
        """Of directions 45 degrees off the normal: a full turn of the first number is 2 pi sin of that, the square of the sine
        grows at 2 sin cos."""
        across, up = 2 * np.pi * np.sqrt(0.5) / 2 ** size[0], 1 / 3 ** size[1]
        assert 1 / 3 < across / up < 3


def test_the_finest_boxes_that_lines_fill():
    types = choose("cpu").types
    lines = np.geomspace(1e3, 1e8, 40).astype(np.uint32)
    found = [boxes_for(types, upload(types.UInt32, np.array([some, some, 0, 7]))) for some in lines]
    counts = [0 if boxes is None else boxes.count for boxes in found]
    assert counts == sorted(counts)
    assert set(counts) == {0, *(strata.boxes(*size) for size in strata.SIZES)}
    assert all(count * strata.FULL <= some for some, count in zip(lines, counts, strict=True))


@pytest.mark.parametrize(("others", "taken"), [(60, True), (140, False)])
def test_lines_of_patches_that_fill_no_boxes_are_few(others, taken):
    """A patch with a hundred thousand lines takes the second boxes, unless those with a hundred each fire a tenth in all."""
    types = choose("cpu").types
    found = boxes_for(types, upload(types.UInt32, np.array([110_000] + [100] * others, dtype=np.uint32)))
    assert (found is not None) is taken
    assert found is None or found.count == strata.boxes(*strata.SIZES[1])
