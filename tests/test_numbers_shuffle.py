"""Shuffled copies of a sequence: permutations that keep its blocks and have nothing else in common."""

import numpy as np
import pytest
from nets import T, is_net, top_digits
from scipy import stats

from radiosity.device.backend import choose, upload
from radiosity.sampling.numbers import DIMENSIONS, NUMBERS, make
from radiosity.sampling.numbers.shuffle import SHUFFLE_BITS, key, shuffled
from radiosity.sampling.streams import Purpose, stream

ALPHA = 1e-4  # of each test, divided by the number of its comparisons
KEYS = 40_000


def words(seed=0):
    types = choose("cpu").types
    return [types.UInt32(int(word)) for word in make("sobol").randomisation(stream(seed, 0, Purpose.NUMBERS))]


def keys(count=KEYS, seed=0):
    """(count,) of the legs from 1 on."""
    types = choose("cpu").types
    return np.array(key(words(seed), upload(types.UInt32, np.arange(1, count + 1, dtype=np.uint32))))


def moved(index, by):
    """Zero-based lines to zero-based points, of one key or a key each."""
    types = choose("cpu").types
    index = np.asarray(index)
    by = np.broadcast_to(np.asarray(by, np.uint32), index.shape)
    found = shuffled(*(upload(types.UInt32, a.astype(np.uint32)) for a in (index + 1, by)))
    return np.array(found).astype(np.int64) - 1


def moved_by_all(index, by):
    """(keys, lines)"""
    index, by = np.asarray(index), np.asarray(by)
    return moved(np.tile(index, len(by)), np.repeat(by, len(index))).reshape(len(by), len(index))


def uniform(cell, cells, comparisons=1) -> bool:
    counts = np.bincount(np.unique(cell, return_inverse=True)[1], minlength=cells)
    return len(counts) == cells and stats.chisquare(counts).pvalue > ALPHA / comparisons


def test_a_shuffle_is_a_bijection():
    import drjit as dr

    types = choose("cpu").types
    index = dr.arange(types.UInt32, 2**SHUFFLE_BITS) + 1
    bits = dr.zeros(types.UInt32, 2**SHUFFLE_BITS // 32)
    place = shuffled(index, types.UInt32(int(keys(1)[0]))) - 1
    dr.scatter_reduce(dr.ReduceOp.Or, bits, types.UInt32(1) << (place & 31), place >> 5)
    assert dr.all(bits == 0xFFFFFFFF)


def test_leg_zero_keeps_its_order():
    types = choose("cpu").types
    zero = key(words(), types.UInt32(0))
    assert int(zero[0]) == 0
    index = np.array([0, 1, 2, 12345, 2**SHUFFLE_BITS - 1])
    assert np.array_equal(moved(index, 0), index)
    assert moved(2**SHUFFLE_BITS + index[:3], 0).tolist() == [0, 1, 2]


def test_legs_and_seeds_have_keys_of_their_own():
    found = np.concatenate([keys(), keys(seed=1)])
    assert len(np.unique(found)) > len(found) - 10  # birthdays
    assert len(np.unique(keys())) == KEYS
    assert found.min() > 0


@pytest.mark.parametrize("m", [0, 1, 3, 8, 15])
def test_blocks_are_moved_onto_blocks(m, random):
    for leg, block in enumerate(random.integers(0, 2**SHUFFLE_BITS >> m, 5)):
        place = moved((block << m) + np.arange(2**m), keys(5)[leg])
        assert len(np.unique(place >> m)) == 1
        assert len(np.unique(place)) == 2**m


def test_over_the_keys_every_nested_permutation_is_as_likely():
    """Eight lines in a row have 2^7 nested permutations; two fours in blocks far apart have 2^3 each, on their own."""
    by = keys()
    for begin in (0, 8, 4096, 987_648):
        place = moved_by_all(begin + np.arange(8), by)
        assert uniform(place % 8 @ 8 ** np.arange(8), 128, 4)
        assert uniform((place[:, 0] >> 3) % 64, 64, 4)
    for far in (4, 2**5, 2**10, 2**20, 2**27):
        place = moved_by_all([0, 1, 2, 3, far, far + 1, far + 2, far + 3], by) % 4
        assert uniform(place @ 4 ** np.arange(8), 64, 5)
    place = moved_by_all(np.arange(4) << 26, by) >> 26
    assert uniform(place @ 4 ** np.arange(4), 8)


def test_a_hash_that_carries_only_is_rejected():
    """Laine and Karras's hash as Burley has it: neighbours have half of the nested permutations."""
    import drjit as dr

    types = choose("cpu").types
    by = keys()
    x = dr.brev(upload(types.UInt32, np.tile(np.arange(8, dtype=np.uint32), KEYS))) + upload(types.UInt32, np.repeat(by, 8))
    for factor in (0x6C50B47C, 0xB82F1E52, 0xC7AFE638, 0x8D22F6E6):
        x ^= x * factor
    place = np.array(dr.brev(x)).astype(np.int64).reshape(KEYS, 8)
    assert not uniform(place % 8 @ 8 ** np.arange(8), 128)


def test_copies_of_a_net_are_nets():
    for leg, name in enumerate(("sobol", "niederreiter"), start=1):
        for m in (6, 10):
            lines = 3 * 2**m + np.arange(2**m)
            place = moved(lines, keys(3)[leg])
            assert not np.array_equal(place >> m, lines >> m)
            assert is_net(top_digits(name, place + 1, 12), 2, 12, m, T[name][DIMENSIONS])


@pytest.mark.parametrize("name", NUMBERS)
def test_legs_are_uncorrelated(name):
    """Coordinates of lines drawn at random on legs 0 and 1, and on 1 and 2: all pairs are uniform in the square."""
    types = choose("cpu").types
    numbers, drawn = make(name), make(name).randomisation(stream(5, 0, Purpose.NUMBERS))
    randomisation = [types.UInt32(int(word)) for word in drawn]
    index = upload(types.UInt32, np.random.default_rng(7).integers(1, 2**SHUFFLE_BITS + 1, 20_000).astype(np.uint32))
    legs = []
    for leg in range(3):
        at = shuffled(index, key(randomisation, types.UInt32(leg)))
        legs.append(np.array(numbers.points(at, types.UInt32(leg), randomisation, 32)))
    for one, other in ((0, 1), (1, 2)):
        for a in legs[one]:
            for b in legs[other]:
                counts, *_ = np.histogram2d(a, b, bins=10, range=[[0, 1], [0, 1]])
                assert stats.chisquare(counts.ravel()).pvalue > ALPHA / (2 * DIMENSIONS**2)


def test_in_the_first_block_correlation_of_legs_has_mean_zero():
    lines = np.arange(256)
    halves = lines % 2 - 0.5  # the first digit of a base 2 coordinate on leg 0
    digits = moved_by_all(lines, keys(2000)) % 2 - 0.5
    assert stats.ttest_1samp(digits @ halves, 0).pvalue > ALPHA
    assert np.abs(digits.sum(axis=1)).max() == 0
