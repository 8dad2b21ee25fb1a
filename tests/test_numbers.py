"""Contract of a number sequence: what every member must keep, and what each of them is."""

import numpy as np
import pytest
from scipy import stats

from radiosity.engine.device import choose, upload
from radiosity.engine.quanta import stream
from radiosity.method.numbers import DIMENSIONS, NUMBERS, WORDS, make

ALPHA = 1e-4  # of each test, divided by the number of its comparisons


def points(name, index, *, patch=0, seed=0, bits=32, zero=False):
    types = choose("cpu").types
    numbers = make(name)
    drawn = np.zeros(WORDS, np.uint32) if zero else numbers.randomisation(stream(seed, 0, 1))
    randomisation = [types.UInt32(int(word)) for word in drawn]
    index = np.asarray(index, np.uint32)
    patches = upload(types.UInt32, np.full(len(index), patch, np.uint32))
    columns = numbers.points(upload(types.UInt32, index), patches, randomisation, bits)
    return np.stack([np.broadcast_to(np.array(c), len(index)) for c in columns], axis=1)


@pytest.mark.parametrize("name", NUMBERS)
class TestContract:
    def test_random_access_gives_the_same_point_in_any_company(self, name):
        index = np.array([1, 2, 3, 1000, 2**19 + 5, 2**31, 2**32 - 1])
        alone = np.concatenate([points(name, [i], patch=4) for i in index])
        assert np.array_equal(alone, points(name, index, patch=4))
        assert np.array_equal(alone[::-1], points(name, index[::-1], patch=4))

    def test_bits_do_not_change_a_point(self, name):
        for bits in make(name).steps():
            index = np.unique(np.r_[1:200, np.linspace(1, 2**bits - 1, 5000).astype(np.int64)])
            assert np.array_equal(points(name, index, bits=bits), points(name, index, bits=32))

    def test_points_lie_in_the_half_open_cube(self, name):
        x = points(name, np.r_[1:100_000, 2**32 - 1])
        assert x.shape[1] == DIMENSIONS
        assert x.min() >= 0
        assert x.max() < 1

    def test_numbers_are_uniform(self, name):
        x = points(name, np.arange(1, 40_001), seed=11)
        for column in x.T:
            assert stats.kstest(column, "uniform").pvalue > ALPHA / DIMENSIONS

    def test_pairs_of_dimensions_fill_the_square(self, name):
        x = points(name, np.arange(1, 40_001), seed=12)
        for a in range(DIMENSIONS):
            for b in range(a):
                counts, *_ = np.histogram2d(x[:, a], x[:, b], bins=10, range=[[0, 1], [0, 1]])
                assert stats.chisquare(counts.ravel()).pvalue > ALPHA / 6

    def test_seeds_and_replicates_differ(self, name):
        assert not np.array_equal(points(name, np.arange(1, 50), seed=1), points(name, np.arange(1, 50), seed=2))
        drawn = [make(name).randomisation(stream(0, replicate, 1)) for replicate in range(50)]
        assert len({tuple(d) for d in drawn}) == 50


def test_a_biased_generator_is_rejected():
    x = points("random", np.arange(1, 40_001))
    assert stats.kstest(x[:, 0] ** 1.05, "uniform").pvalue < ALPHA / DIMENSIONS
    assert stats.chisquare(np.histogram2d(x[:, 0], x[:, 0], bins=10, range=[[0, 1], [0, 1]])[0].ravel()).pvalue < ALPHA


def test_halton_is_scipys():
    exact = stats.qmc.Halton(DIMENSIONS, scramble=False).random(5000)
    assert np.abs(points("halton", np.arange(5000), zero=True) - exact).max() < 2e-7


def test_halton_at_large_indices():
    index = np.array([2**24 + 12345, 2**31 - 1, 2**32 - 1])
    for column, base in zip(points("halton", index, zero=True).T, (2, 3, 5, 7, 11), strict=True):
        for i, value in zip(index.tolist(), column, strict=True):
            exact, scale = 0.0, 1.0
            while i:
                scale /= base
                exact, i = exact + scale * (i % base), i // base
            assert abs(exact - value) < 2e-7


def test_halton_patches_share_one_sequence_and_random_patches_do_not():
    index = np.arange(1, 100)
    assert np.array_equal(points("halton", index, patch=1), points("halton", index, patch=2))
    assert not np.array_equal(points("random", index, patch=1), points("random", index, patch=2))


def test_random_is_philox():
    """Known answers of the authors' Random123 (kat_vectors, philox4x32 with 10 rounds)."""
    from radiosity.method.numbers.random import philox

    types = choose("cpu").types
    cases = [
        ([0] * 6, [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8]),
        ([0xFFFFFFFF] * 6, [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD]),
        (
            [0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344, 0xA4093822, 0x299F31D0],
            [0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1],
        ),
    ]
    for words, expected in cases:
        given = [types.UInt32(w) for w in words]
        assert [int(w[0]) for w in philox(given[:4], given[4:])] == expected
