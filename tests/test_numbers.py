"""Contract of a number sequence: what every member must keep, and what each of them is."""

import numpy as np
import pytest
from scipy import stats

from radiosity.device.backend import choose, upload
from radiosity.errors import MethodError
from radiosity.sampling.numbers import DIMENSIONS, NUMBERS, WORDS, make
from radiosity.sampling.streams import Purpose, stream
from radiosity.tracing.faces import COLUMN_BITS
from radiosity.tracing.ray_generation import place_number

ALPHA = 1e-4  # of each test, divided by the number of its comparisons


def points(name, index, *, patch=0, seed=0, bits=32, zero=False, turns=None, of_patch=False):
    """Those of each index; or of ``turns`` from each index on, (turns, n, DIMENSIONS)."""
    import drjit as dr

    types = choose("cpu").types
    numbers = make(name)
    drawn = np.zeros(WORDS, np.uint32) if zero else numbers.randomisation(stream(seed, 0, Purpose.NUMBERS))
    randomisation = [dr.opaque(types.UInt32, int(word)) for word in drawn]  # no literals: one kernel
    index = np.asarray(index, np.uint32)
    patches = upload(types.UInt32, np.broadcast_to(np.asarray(patch, np.uint32), index.shape))
    index = upload(types.UInt32, index)
    if of_patch:
        randomisation = numbers.of_patch(randomisation, patches)
    if turns is None:
        found = [numbers.points(index, patches, randomisation, bits)]
    else:
        in_turn = numbers.in_turn(index, patches, lambda index: randomisation, bits, turns)
        found = [in_turn(types.UInt32(turn)) for turn in range(turns)]
    found = np.stack([np.stack([np.broadcast_to(np.array(c), len(patches)) for c in point], axis=1) for point in found])
    return found[0] if turns is None else found


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

    @pytest.mark.parametrize("turns", [2, 8, 9])
    def test_points_in_turn_are_those_of_their_indices(self, name, turns):
        """Also across the carries of every digit, and where an index needs a second pass."""
        carries = np.unique([base**digits for base in (2, 3, 5, 7, 11) for digits in range(1, 32) if base**digits < 2**31])
        for bits in make(name).steps():
            first = np.r_[1:3000, carries, np.random.default_rng(bits).integers(1, 2**bits - turns, 3000)]
            first = np.unique(np.r_[first, *(carries - back for back in range(1, turns))])
            first = first[(first > 0) & (first < 2**bits - turns)]
            found = points(name, first, bits=bits, turns=turns)
            for turn in range(turns):
                assert np.array_equal(found[turn], points(name, first + turn))

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
                assert stats.chisquare(counts.ravel()).pvalue > ALPHA / (DIMENSIONS * (DIMENSIONS - 1) / 2)

    def test_seeds_and_replicates_differ(self, name):
        assert not np.array_equal(points(name, np.arange(1, 50), seed=1), points(name, np.arange(1, 50), seed=2))
        drawn = [make(name).randomisation(stream(0, replicate, Purpose.NUMBERS)) for replicate in range(50)]
        assert len({tuple(d) for d in drawn}) == 50
        assert all(d.shape == (WORDS,) and d.dtype == np.uint32 for d in drawn)

    def test_means_over_replicates_are_unbiased(self, name):
        """Of a product whose mean is 1; and a low discrepancy sequence has less than half the random error."""
        n, replicates = 250, 200
        products = [np.prod(0.5 + points(name, np.arange(1, n + 1), seed=seed), axis=1) for seed in range(replicates)]
        means = np.mean(products, axis=1)
        assert stats.ttest_1samp(means, 1.0).pvalue > ALPHA
        exact = ((1 + 1 / 12) ** DIMENSIONS - 1) / n  # the variance of a random mean
        ratio = means.var(ddof=1) / exact
        if name == "random":
            bound = stats.chi2.ppf([ALPHA / 2, 1 - ALPHA / 2], replicates - 1) / (replicates - 1)
            assert bound[0] / 1.5 < ratio < bound[1] * 1.5  # the means are not quite normal
        else:
            assert ratio < 0.25

    def test_other_indices_and_replicates_need_no_other_kernel(self, name):
        import drjit as dr

        points(name, np.arange(1, 1001))
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
            dr.kernel_history_clear()
            points(name, np.arange(5001, 6001), seed=9, patch=3)
            history = [kernel for kernel in dr.kernel_history() if kernel["type"] == dr.KernelType.JIT]
        assert history
        assert all(kernel["cache_hit"] for kernel in history)

    def test_indices_beyond_the_last_are_refused(self, name):
        numbers = make(name)
        assert numbers.bits_for(1) == numbers.steps()[0]
        assert numbers.bits_for(numbers.largest()) == numbers.steps()[-1] == 32
        for bits in numbers.steps():
            assert numbers.bits_for(2**bits - 1) == bits
        with pytest.raises(MethodError, match=f"line {numbers.largest() + 1}; take fewer lines"):
            numbers.bits_for(numbers.largest() + 1)


def test_a_biased_generator_is_rejected():
    x = points("random", np.arange(1, 40_001))
    assert stats.kstest(x[:, 0] ** 1.05, "uniform").pvalue < ALPHA / DIMENSIONS
    assert stats.chisquare(np.histogram2d(x[:, 0], x[:, 0], bins=10, range=[[0, 1], [0, 1]])[0].ravel()).pvalue < ALPHA


@pytest.mark.parametrize("name", NUMBERS)
class TestPatches:
    """Points with the randomisation of a patch, `of_patch`."""

    def test_patches_have_points_of_their_own(self, name):
        index = np.arange(1, 100)
        found = [points(name, index, patch=patch, of_patch=True) for patch in (0, 1, 2, 77_777)]
        assert len({x.tobytes() for x in found}) == 4
        assert np.array_equal(found[3], points(name, index, patch=77_777, of_patch=True))
        shared = [points(name, index, patch=patch) for patch in (0, 1)]
        assert np.array_equal(*shared) == (name != "random")  # those of the replicate are the same for all
        assert np.array_equal(found[0], shared[0])

    @pytest.mark.parametrize("patch", [1, 30, 99_999, 2**31 - 1])
    def test_the_points_of_a_patch_are_uniform(self, name, patch):
        x = points(name, np.arange(1, 40_001), patch=patch, seed=13, of_patch=True)
        assert x.min() >= 0
        assert x.max() < 1
        comparisons = 4 * DIMENSIONS * (DIMENSIONS + 1) / 2
        for a in range(DIMENSIONS):
            assert stats.kstest(x[:, a], "uniform").pvalue > ALPHA / comparisons
            for b in range(a):
                counts, *_ = np.histogram2d(x[:, a], x[:, b], bins=10, range=[[0, 1], [0, 1]])
                assert stats.chisquare(counts.ravel()).pvalue > ALPHA / comparisons


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("cells", [(10, 10), (34, 34), (158, 6)])
def test_a_line_of_all_patches_of_a_face_fills_the_square(name, cells):
    """The k-th lines of the patches of a face: at least as evenly over 4 x 4 or 8 x 8 boxes as random points."""
    columns, rows = (axis.ravel() for axis in np.meshgrid(*map(np.arange, cells)))
    boxes, shares = 4 if len(columns) < 500 else 8, []
    for face, index in ((0, 1), (7, 6), (80_000, 50)):
        record = np.full(len(columns), face, np.uint32), (columns | rows << COLUMN_BITS).astype(np.uint32)
        places = place_number([upload(choose("cpu").types.UInt32, part) for part in record])
        x = points(name, np.full(len(columns), index), patch=np.array(places), seed=14, of_patch=True)
        for a in range(DIMENSIONS):
            for b in range(a):
                counts, *_ = np.histogram2d(x[:, a], x[:, b], bins=boxes, range=[[0, 1], [0, 1]])
                found = stats.chisquare(counts.ravel())
                assert found.pvalue > ALPHA / (9 * DIMENSIONS * (DIMENSIONS - 1) / 2)
                shares.append(found.statistic / (boxes**2 - 1))
    assert np.mean(shares) < (1.3 if name == "random" else 0.7)  # of squares that random points have


def test_random_is_philox():
    """Known answers of the authors' Random123 (kat_vectors, philox4x32 with 10 rounds)."""
    from radiosity.sampling.numbers.random import philox

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
