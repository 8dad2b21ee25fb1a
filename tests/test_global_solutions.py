"""Solutions by global lines: furnaces, comparison with the firing engine, books, exchange in whole numbers.

Bounds are in standard errors that replicates state, with fixed seeds: SIGMAS for a mean (Student, 15 degrees of freedom:
p = 4e-4, about 40 comparisons), LARGEST for the largest of some hundred patches.
"""

from functools import cache

import numpy as np
import pytest
from enclosures import cube
from replicates import powers
from test_lines import stack

import radiosity as rd
from radiosity.algorithms.global_lines.exchange import Exchange
from radiosity.algorithms.global_lines.mixing import Mixed
from radiosity.device.backend import choose, frozen, upload
from radiosity.problem.model import Problem
from radiosity.scene.shapes import quad
from radiosity.tally.wraps import Wraps
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.global_lines.spans import CODES, ESCAPED, LOST, ONE_WAY, Spans

SIGMAS, LARGEST = 4.5, 6.5
KINDS = ("global", "global-disc", "spans", "bundles")
METHODS = [
    rd.Method(lines=lines, order=order, first_shot=shot)
    for lines in KINDS
    for order in ("multipath", "regular")
    for shot in (0.0, 0.25)
    if (lines, order) != ("bundles", "multipath")
]


def shown(method: rd.Method) -> str:
    return str(method).removeprefix("discrete/")


some = pytest.mark.parametrize("method", METHODS, ids=shown)


def opening(back: rd.Back = rd.Back.RADIATES) -> rd.Scene:
    """Four squares in the open, two different bands."""
    quads = [
        quad((0, 0, 0), (2, 0, 0), (0, 2, 0)),
        quad((0.3, 0.3, 1.0), (1, 0, 0), (0, 1, 0.5)),
        quad((0, 0, 2), (0, 2, 0), (2, 0, 0)),
        quad((-1, 0, 0), (0, 0, 1.5), (0, 1, 0)),
    ]
    return rd.Scene.from_arrays(
        np.concatenate(quads),
        np.arange(16).reshape(4, 4),
        [[0.5, 0.2], [0.8, 0.8], [0.3, 0.6], [0.7, 0.7]],
        [[1.0, 2.0], [0.0, 0.0], [0.2, 0.0], [0.0, 0.0]],
        back=[back] * 4,
        surface=range(4),
        names=list("abcd"),
        bands=["x", "y"],
    )


def replicate_powers(solution, group=0):
    """(replicates, surfaces and sides) received power, from the run's state."""
    patches = solution.patches
    return powers(solution, key=2 * patches.surface + patches.is_back, group=group)


def same(solution, reference):
    """Received power of every surface and side, and all that escaped or was lost, agree within their errors."""
    for group in range(Problem.of(solution.patches).groups.n_groups):
        one, two = (replicate_powers(s, group) for s in (solution, reference))
        error = np.hypot(*(x.std(axis=0, ddof=1) / len(x) ** 0.5 for x in (one, two)))
        difference = one.mean(axis=0) - two.mean(axis=0)
        assert (np.abs(difference) <= SIGMAS * error + 1e-4 * two.mean(axis=0).max()).all()
    for book, other in zip(solution.books, reference.books, strict=True):
        for name in ("absorbed", "escaped", "lost"):
            assert book[name] == pytest.approx(other[name], abs=0.03 * book["emitted"])
        assert book["emitted"] == pytest.approx(other["emitted"])
        assert book["emitted"] + book["rounding"] == pytest.approx(book["absorbed"] + book["escaped"] + book["lost"])


@pytest.mark.parametrize("mean", [pytest.param(0.5, marks=pytest.mark.slow), 0.9])
@some
def test_labyrinth_furnace_is_one_everywhere(method, mean):
    patches = rd.subdivide(rd.load_scene(f"labyrinth-{mean}"), cells=1)
    solution = rd.solve(patches, method, rays=400_000, replicates=16)
    difference, error = solution.radiosity - 1, solution.standard_error
    # an iteration without a first shot has no error here, since means of equal values are exact: what its warm-up left shows
    assert (np.abs(difference) < LARGEST * error + 4e-4).all()
    assert np.sqrt(np.mean(difference**2)) < 0.01
    assert solution.rays == pytest.approx(400_000, rel=0.05)
    if error.mean() > 1e-4:
        assert np.sqrt(np.mean((difference / error) ** 2)) < 1.5


@pytest.fixture(scope="module")
def references():
    """Solutions by local lines, an order of magnitude more exact."""

    @cache
    def solved(name):
        patches = (
            rd.subdivide(rd.load_scene("room"), cells=3) if name == "room" else rd.subdivide(opening(rd.Back[name]), cells=2)
        )
        return rd.solve(patches, "random-walk", rays=4_000_000, replicates=16, seed=9)

    return solved


TWINS = [rd.Method(lines=lines, order=order) for lines in ("global", "spans") for order in ("multipath", "regular")]
# multipath: its room is in test_table.py, too; with a first shot: backs that pass are the harder ones; and the twins go one way
# through a back below
ELSEWHERE = {
    "room": [method for method in METHODS if method.order == "multipath"],
    "RADIATES": [method for method in METHODS if method.first_shot],
    "PASSES": TWINS,
}
CASES = [
    pytest.param(method, name, marks=[pytest.mark.slow] if method in elsewhere else [], id=f"{shown(method)}-{name}")
    for name, elsewhere in ELSEWHERE.items()
    for method in METHODS
]


@pytest.mark.parametrize(("method", "name"), CASES)
def test_like_local_lines(references, method, name):
    reference = references(name)
    same(rd.solve(reference.patches, method, rays=450_000, replicates=16), reference)


def test_light_goes_one_way_through_a_back_that_lets_it_pass():
    """The receiver sees the sheet's front, and gets the emitter's light through the sheet."""
    patches = rd.subdivide(stack(rd.Back.PASSES), cells=3)
    reference = rd.solve(patches, "random-walk", rays=2_000_000, replicates=16, seed=9)
    for method in TWINS:
        same(rd.solve(patches, method, rays=1_000_000, replicates=16), reference)


def test_exchange_is_what_whole_numbers_say(random):
    """Against Python's integers, span by span, with every kind of end."""
    types, n = choose("cpu").types, 9
    rho = (random.random(n) * 0.9 * 2**32).astype(np.uint32)
    source = random.integers(0, 2**34, (2, n)).astype(np.uint64)
    lengths, unshot, landed, ledger = [700, 500], np.zeros((2, n), object), np.zeros((2, n), object), np.zeros((4, 2), object)
    ones, others = [], []
    for r, length in enumerate(lengths):
        one = random.integers(0, n, length)
        other = (one + 1 + random.integers(0, n - 1, length)) % n
        kind = random.integers(0, 8, length)
        one = np.where(kind == 0, ESCAPED, np.where(kind == 1, LOST, one))
        other = np.where(kind == 2, ESCAPED, np.where(kind == 3, LOST, np.where(kind == 4, other + ONE_WAY, other)))
        ones.append(one.astype(np.uint32))
        others.append(other.astype(np.uint32))
        for i, j in zip(one.tolist(), other.tolist(), strict=True):
            away = [0, 0]
            for at, end in enumerate((i, j)):
                if end < ONE_WAY:  # who is only seen sends nothing
                    away[at] = int(unshot[r, end]) + int(source[r, end])
                    unshot[r, end] = 0
            for power, to in ((away[0], j), (away[1], i)):
                ledger[0, r] += power
                if to < CODES:
                    to &= ONE_WAY - 1
                    kept = power * int(rho[to]) >> 32
                    unshot[r, to] += kept
                    landed[r, to] += power
                    ledger[1, r] += kept
                else:
                    ledger[2 if to == ESCAPED else 3, r] += power
    exchange = Exchange(
        types,
        True,
        upload(types.UInt32, rho),
        upload(types.UInt64, source),
        *(upload(types.UInt64, np.zeros(2 * n, np.uint64)) for _ in range(2)),
        Wraps(types, 64),
    )
    both = (upload(types.UInt32, np.concatenate(ends)) for ends in (ones, others))
    sums = exchange.run(*both, np.array(lengths), n)
    assert frozen(exchange.unshot).reshape(2, n).tolist() == unshot.tolist()
    assert frozen(exchange.landed).reshape(2, n).tolist() == landed.tolist()
    assert sums.tolist() == ledger.tolist()


def test_multipath_books_close_to_the_last_unit():
    for scene in (rd.load_scene("room"), opening()):
        for book in rd.solve(rd.subdivide(scene, cells=2), rd.Method(lines="global", order="multipath"), rays=200_000).books:
            assert book["closes"] is True
            assert abs(book["rounding"]) < 0.05 * book["emitted"]


def test_mixed_order_holds_the_same_spans():
    patches = rd.subdivide(rd.load_scene("room"), cells=1)
    for lines in ("global", "spans"):
        spans = Spans(Geometry(patches, choose("cpu")), rd.Method(lines=lines, order="multipath"), 0, 2)
        mixed = Mixed(spans)
        block = mixed.block
        drawn, plain = mixed.draw(1, 0, 2 * block), spans.draw(1, 0, 2 * block)
        assert (np.diff(drawn.line.astype(int)) >= 0).all()
        for part in (slice(0, block), slice(block, 2 * block)):
            a, b = (slice(*np.searchsorted(p.line, (part.start, part.stop))) for p in (drawn, plain))
            both = [np.sort(p.one[s].astype(np.uint64) << np.uint64(32) | p.other[s]) for p, s in ((drawn, a), (plain, b))]
            assert np.array_equal(*both)
        pieces = [mixed.draw(1, first, count) for first, count in ((0, 100), (100, block), (block + 100, block - 100))]
        assert np.array_equal(np.concatenate([piece.one for piece in pieces]), drawn.one)


def test_one_replicate_has_no_error_and_a_seed_repeats_itself():
    patches = rd.subdivide(rd.load_scene("room"), cells=1)
    for order in ("multipath", "regular"):
        method = rd.Method(lines="spans", order=order)
        one, two = (rd.solve(patches, method, rays=100_000, replicates=1, seed=4) for _ in range(2))
        assert np.isnan(one.irradiance_standard_error).all()
        assert np.array_equal(one.irradiance, two.irradiance)
        longer = rd.solve(patches, method, rays=300_000, replicates=1, seed=4, resume=one)
        again = rd.solve(patches, method, quanta=longer.quanta, replicates=1, seed=4)
        assert longer.irradiance == pytest.approx(again.irradiance, rel=1e-12)


@some
def test_every_line_of_a_closed_scene_lands(method):
    """Both ends of a span are lines that land, and those of a first shot land, too."""
    patches = rd.subdivide(cube(0.5, [1.0, 0, 0, 0, 0, 0]), cells=2)
    solution = rd.solve(patches, method, rays=8_000)
    assert solution.arrivals.sum() == solution.rays > 7_000


@pytest.mark.parametrize("order", ["multipath", "regular"])
@pytest.mark.parametrize("share", [0.1, 0.5, 0.8])
def test_a_first_shot_has_its_share_of_all_lines(order, share):
    patches = rd.subdivide(cube(0.5, [1.0, 0, 0, 0, 0, 0]), cells=2)
    solution = rd.solve(patches, rd.Method(lines="spans", order=order, first_shot=share), rays=20_000)
    assert solution.state["shot_fired"].sum() / solution.rays == pytest.approx(share, abs=0.01)
