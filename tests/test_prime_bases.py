"""Walks in prime bases of their own: points against scipy and whole numbers, and walks that take them."""

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

import radiosity as rd
from radiosity.algorithms.walks.particles import ParticleBank, PathSegments
from radiosity.device.backend import choose, upload
from radiosity.sampling.numbers import DIMENSIONS, WORDS
from radiosity.sampling.numbers.prime_bases import COUNT, PrimeBases, primes
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.line_tracer import LineTracer

ALPHA = 1e-4
KELLER = rd.Method(equation="continuous", absorption="fractional", padding="prime-bases")


def points(index, segment, dimensions=(0, 1), words=(0,) * WORDS) -> np.ndarray:
    """(n, 5) numbers of a segment."""
    types = choose("cpu").types
    index = upload(types.UInt32, np.asarray(index, np.uint32))
    given = [types.UInt32(int(word)) for word in words]
    made = PrimeBases.of(types, dimensions).points(index, upload(types.UInt32, np.full(len(index), segment, np.uint32)), given)
    return np.stack([np.broadcast_to(np.array(column), len(index)) for column in made], axis=1)


def inverse(index: int, base: int) -> float:
    """The digits of a whole number mirrored at the point, by whole numbers."""
    value, place = 0, 1
    while index:
        index, digit = divmod(index, base)
        value, place = value * base + digit, place * base
    return value / place


def test_the_first_primes_are_there():
    found = primes(COUNT)
    assert found[:4].tolist() == [13, 17, 19, 23]
    assert len(found) == COUNT
    assert found[-1] == 84067  # the 8197th prime


@pytest.mark.parametrize("dimensions", [(0, 1), (0, 1, 4), (0, 1, 2, 3), (0, 1, 2, 3, 4)])
def test_segments_go_on_with_the_halton_sequence(dimensions):
    """Segment k of walk n has the next numbers of point n of the Halton sequence of scipy."""
    legs, n = 4, len(dimensions)
    whole = qmc.Halton(5 + legs * n, scramble=False).random(3001)[1:]
    for segment in range(1, legs + 1):
        found = points(np.arange(1, 3001), segment, dimensions)
        first = 5 + (segment - 1) * n
        assert np.abs(found[:, dimensions] - whole[:, first : first + n]).max() < 2**-22
        assert not np.delete(found, dimensions, axis=1).any()


def test_large_indices_and_bases_are_exact():
    index = np.r_[np.random.default_rng(1).integers(1, 2**32, 200), 2**32 - 1, 84067 * 51031 - 1]
    for segment in (1, 15, 1000, COUNT // 2):
        bases = primes(COUNT)[2 * segment - 2 : 2 * segment]
        exact = np.array([[inverse(int(i), int(base)) for base in bases] for i in index])
        apart = np.abs(points(index, segment)[:, :2] - exact)
        assert np.minimum(apart, 1 - apart).max() < 2**-22


def test_points_are_moved_and_stay_in_the_cube():
    words = np.random.default_rng(2).integers(0, 2**32, WORDS)
    apart = points(np.arange(1, 2001), 7, words=words)[:, :2] - points(np.arange(1, 2001), 7)[:, :2] - words[:2] / 2**32
    assert np.abs(apart - np.round(apart)).max() < 2**-21
    assert points(np.arange(1, 100_000), 2, words=[2**32 - 1] * WORDS).max() < 1


def test_behind_the_table_the_primes_begin_again_in_another_order():
    last = COUNT // DIMENSIONS
    one, two = (points(np.arange(1, 5000), segment, tuple(range(DIMENSIONS))) for segment in (1, last + 1))
    assert not np.array_equal(one, two)
    again, _ = np.histogram(two[:, 0], bins=13, range=(0, 1))
    assert stats.chisquare(again).pvalue > ALPHA


def fills_the_square(x, y) -> bool:
    counts, *_ = np.histogram2d(x, y, bins=8, range=[[0, 1], [0, 1]])
    return bool(stats.chisquare(counts.ravel()).pvalue > ALPHA)


def test_numbers_of_two_segments_fill_the_square_and_equal_bases_would_not():
    one, two = (points(np.arange(1, 20_001), segment, words=[segment * 2**30] * WORDS) for segment in (1, 2))
    assert fills_the_square(one[:, 0], two[:, 0])
    equal = points(np.arange(1, 20_001), 1, words=[2**31] * WORDS)  # the base of segment 1 once more, with another shift
    assert not fills_the_square(one[:, 0], equal[:, 0])


@pytest.mark.parametrize(
    "method",
    [KELLER, rd.Method(absorption="drawn", padding="prime-bases"), rd.Method(estimator="gathering", padding="prime-bases")],
    ids=str,
)
def test_the_furnace_is_solved(method):
    """B = 1 everywhere. Bounds: the mean of 16 replicates is within six standard errors on all of 70 patches (alpha 1e-3)."""
    patches = rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1)
    solution = rd.solve(patches, method, rays=1_500_000, replicates=16, seed=4)
    assert (np.abs(solution.radiosity - 1) / solution.standard_error).max() < 6
    assert solution.error < 0.01


def test_orders_end_in_equal_sums():
    """Walks that are followed together and one by one, a segment at a time and in one kernel."""
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    walks = {"equation": "continuous", "padding": "prime-bases"}
    one, two = (
        rd.solve(patches, rd.Method(order=order, **walks), quanta=5000, replicates=2) for order in ("staged", "depth-first")
    )
    assert np.array_equal(one.state["arrivals"], two.state["arrivals"])
    assert np.array_equal(one.state["received"], two.state["received"])


@pytest.mark.parametrize(("absorption", "one"), [("fractional", True), ("drawn", False)])
def test_walks_of_all_patches_have_one_sequence_where_absorption_is_fractional(absorption, one):
    """Walk 7, whichever patch it begins on; drawn walks of patches are moved by hashes, or walk 7 of all would end together."""
    types, geometry = choose("cpu").types, Geometry(rd.subdivide(rd.load_scene("room"), cells=2), choose("cpu"))
    method = rd.Method(absorption=absorption, padding="prime-bases")
    segments = PathSegments(LineTracer.of(geometry, "halton", "shared", 1, 2), method)
    walk = upload(types.UInt32, np.arange(0, 60, 5, dtype=np.uint32))
    particles = ParticleBank(walk, upload(types.UInt32, np.full(12, 7, np.uint32)), (walk,), ())
    numbers = segments.later(particles, upload(types.UInt32, np.full(12, 3, np.uint32))).numbers
    assert len(np.unique(np.array(numbers[0]))) == (1 if one else 12)
    assert (np.array(numbers[4]).max() == 0) == one  # no number for a choice


def test_it_is_told_and_has_other_walks():
    assert str(KELLER) == "continuous/local/breadth-first/halton/prime-bases/fractional"
    patches = rd.subdivide(rd.load_scene("room"), cells=2)
    shuffled = rd.Method(equation="continuous", absorption="fractional")
    one, two = (rd.solve(patches, method, quanta=5000, replicates=2) for method in (KELLER, shuffled))
    assert not np.array_equal(one.arrivals, two.arrivals)
    assert np.array_equal(one.arrivals, rd.solve(patches, KELLER, quanta=5000, replicates=2).arrivals)


@pytest.mark.parametrize(
    ("choices", "reason"),
    [
        ({}, "is for walks that take numbers on each segment"),
        ({"order": "sorted", "equation": "continuous"}, "is for walks"),
        ({"order": "gather"}, "is for walks"),
        ({"equation": "continuous", "numbers": "sobol"}, "take --numbers halton"),
        ({"equation": "continuous", "scrambling": "permuted-digits"}, "not scrambled-halton"),
    ],
)
def test_it_is_refused_where_it_means_nothing(choices, reason):
    with pytest.raises(rd.MethodError, match=reason):
        rd.Method(padding="prime-bases", **choices)
