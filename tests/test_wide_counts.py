"""Counts beyond 32 bits: runs that begin near the border, with counters as they are after very many lines.

No test traces so many lines. A state is made whose counts lie just below 2^32 (or 2^31, or 2^33), and a run goes on from it.
"""

from dataclasses import replace
from types import SimpleNamespace

import drjit as dr
import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.firing.state import BandState, FiringState
from radiosity.algorithms.gather.packets import Packets
from radiosity.algorithms.gather.sums import Sums
from radiosity.algorithms.global_lines import pooling
from radiosity.algorithms.merging import merge
from radiosity.algorithms.state import Sizes
from radiosity.algorithms.table import make
from radiosity.algorithms.walks.state import WalkState
from radiosity.device.backend import choose, frozen, upload
from radiosity.factors.counts import PairCounts
from radiosity.method import Method
from radiosity.method.presets import PRESETS
from radiosity.problem.model import Problem
from radiosity.problem.quanta import target_counts
from radiosity.run.budget import Budget, Progressed, next_quanta
from radiosity.sampling.blocks import BLOCK, Blocks, parts
from radiosity.sampling.numbers import NUMBERS, ready
from radiosity.sampling.streams import Purpose, stream
from radiosity.tally.shooter import Shooter
from radiosity.tally.wraps import Wraps
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.global_lines.spans import Spans

MANY = np.uint64(1) << np.uint64(32)


def nobody(lines):
    pass


@pytest.fixture(scope="module")
def geometry():
    return Geometry(rd.subdivide(rd.load_scene("room"), cells=1).solid, choose("cpu"))


@pytest.fixture(scope="module")
def problem(geometry):
    return Problem.of(geometry.patches)


def algorithm(geometry, problem, method, replicates=2, seed=5):
    return make(geometry, problem, Method(**method), seed, replicates)


def near_the_border(problem, run):
    """A state of the firing engine: the lamp comes to a border after 300 lines, and three rows have been hit very often."""
    lamp, n = int(problem.source.share.argmax()), len(problem.patches)
    quanta = round((3 * 2**32 + 500) / problem.source.share[lamp])
    phase = frozen(run.counters.targets.phase).reshape(2, n)
    hits = np.zeros((2, n), np.uint64)
    hits[:, 1], hits[:, 2], hits[1, 3] = 2**32 - 40, 2**33 - 1, 2**31 - 5
    fired = target_counts(problem.source, quanta, hits, phase)
    fired[:, lamp] = 3 * 2**32 - 300
    missed = np.stack([fired.sum(axis=1) - hits.sum(axis=1) - np.uint64(7), np.full(2, 7, np.uint64)])
    return FiringState(sizes=run.sizes, quanta=quanta, arrivals=hits, fired=fired, missed=missed), phase


@pytest.mark.parametrize("order", ["depth-first", "well-distributed"])
def test_orders_end_in_equal_integers_beyond_the_border(geometry, problem, order):
    ends = []
    for kind in ("breadth-first", order):
        run = algorithm(geometry, problem, {"order": kind, "numbers": "random"})
        begin, phase = near_the_border(problem, run)
        run.restore(begin)
        run.advance(begin.quanta, nobody)
        ends.append(run.capture())
    one, other = ends
    for name in ("arrivals", "fired", "missed"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
    assert (one.fired[:, problem.source.share.argmax()] > 3 * MANY).all()
    assert np.array_equal(one.fired, target_counts(problem.source, begin.quanta, one.arrivals, phase))
    assert (one.arrivals[:, 1] > MANY).all()
    assert (one.arrivals[:, 2] > 2 * MANY).all()
    assert np.array_equal(one.fired.sum(axis=1), one.arrivals.sum(axis=1) + one.missed.sum(axis=0))
    books = run.tally.books(problem, one, 0)
    assert books["closes"] is True
    received, unit = run.tally.irradiance(problem, one, 0)
    assert received[0, 2] * unit == pytest.approx(2.0**33 * problem.source.power / begin.quanta, rel=1e-6)


def traced(tracer, row, first, count, block):
    """Hits of lines of a row of replicate 0, by the tracer of one block alone, (n + 2,)."""
    types = tracer.types
    number = upload(types.UInt32, np.full(count, row, np.uint32))
    index = upload(types.UInt32, (first + np.arange(count)).astype(np.uint32))
    landed = frozen(tracer.of_block(block).trace(number, index, tracer.record(number), 32))
    slots = np.where(landed < tracer.total, landed, tracer.total + (landed - tracer.total) // tracer.replicates)
    return np.bincount(slots, minlength=tracer.total + 2)


@pytest.mark.parametrize(
    "numbers", [*(pytest.param(name, marks=pytest.mark.slow) for name in NUMBERS if name != "halton"), "halton"]
)
def test_lines_beyond_the_border_are_those_of_the_next_block(geometry, problem, numbers):
    black = replace(problem, source=replace(problem.source, rho=np.zeros_like(problem.source.rho)))
    run, lamp = algorithm(geometry, black, {"numbers": numbers}, replicates=1), int(problem.source.share.argmax())
    n, quanta = len(problem.patches), round((2**32 + 40) / problem.source.share[lamp])
    fired = target_counts(black.source, quanta, np.zeros((1, n), np.uint64), frozen(run.counters.targets.phase).reshape(1, n))
    more = int(fired[0, lamp]) - (2**32 - 60)
    fired[0, lamp] -= np.uint64(more)
    run.restore(FiringState(sizes=run.sizes, quanta=quanta, arrivals=0 * fired, fired=fired, missed=np.zeros((2, 1), np.uint64)))
    run.advance(quanta, nobody)
    end, tracer = run.capture(), run.counters.tracer
    expected = traced(tracer, lamp, 2**32 - 59, 59, 0) + traced(tracer, lamp, 0, more - 59, 1)
    assert np.array_equal(np.append(end.arrivals[0], end.missed[:, 0]), expected)
    again = traced(tracer, lamp, 2**32 - 59, 59, 0) + traced(tracer, lamp, 1, more - 59, 0)  # as if the sequence began again
    assert not np.array_equal(expected, again)


def test_blocks_have_streams_of_their_own():
    types = choose("cpu").types
    for name in NUMBERS:
        numbers = ready(name, types)
        blocks = Blocks(numbers, types, 7, 2, Purpose.NUMBERS)
        blocks.prepare(2)
        known = frozen(blocks.known).reshape(-1, 2, 8)
        assert np.array_equal(known[0], [numbers.randomisation(stream(7, r, Purpose.NUMBERS)) for r in range(2)])
        assert np.array_equal(known[2], [numbers.randomisation(stream(7, r, Purpose.NUMBERS, 2)) for r in range(2)])
        assert len(np.unique(known.reshape(-1, 8), axis=0)) == len(known) * 2


def test_lines_are_cut_at_borders():
    done = np.array([5, 2**32 - 3, 2**33 + 1, 0])
    found = [(b, begin.tolist(), more.tolist()) for b, begin, more in parts(done, np.array([10, 2**32 + 6, 1, 0]))]
    assert [(b, more) for b, _, more in found] == [(0, [10, 2, 0, 0]), (1, [0, 2**32, 0, 0]), (2, [0, 4, 1, 0])]
    assert [begin[1] for _, begin, _ in found] == [2**32 - 3, 2**32 - 1, 2**32 - 1]
    assert (found[0][1][0], found[2][1][2]) == (5, 1)
    assert list(parts(done, 0 * done)) == []


@pytest.mark.parametrize("bits", [32, 64])
def test_upper_words_follow_counters_that_wrap_around(bits):
    types, random = choose("cpu").types, np.random.default_rng(3)
    kind, upper = types.UInt32 if bits == 32 else types.UInt64, Wraps(types, bits)
    truth = [0] * 40
    for _ in range(12):
        truth = [count + int(random.integers(0, 2 ** (bits - 1))) for count in truth]
        truth[0] = 0
        low = upload(kind, np.array([count % 2**bits for count in truth], np.uint32 if bits == 32 else np.uint64))
        upper.look(low)
    assert frozen(upper.upper(low)).tolist() == [count >> bits for count in truth]
    other, words = Wraps(types, bits), frozen(low)
    other.of(upper.values(low)) if bits == 32 else other.of(words, upper.read(low))
    assert np.array_equal(frozen(other.halves), frozen(upper.halves))
    few = Wraps(types, bits)
    few.look(upload(kind, np.array([3, 2 ** (bits - 2) - 1], words.dtype)))
    assert few.halves is None  # 32 bits suffice, and no memory is taken


def test_wide_counters_give_the_integers_of_narrow_ones(monkeypatch):
    """Also with bands, whose wavefronts are part of the result, and where counters are looked at every 1000 lines."""
    from radiosity.algorithms.firing import due, fire
    from radiosity.algorithms.firing.counters import FiringCounters

    def widened(self):
        self.wide = True
        self.tracer.blocks.prepare(1)

    for scene, order in (("room", "depth-first"), ("cornell-box", "breadth-first")):
        patches = rd.subdivide(rd.load_scene(scene), cells=2)
        narrow = rd.solve(patches, rd.Method(order=order), quanta=20_000, replicates=2)
        with monkeypatch.context() as patched:
            for module in (due, fire):
                patched.setattr(module, "PERIOD", 50_000)
            patched.setattr(FiringCounters, "_widen", widened)
            wide = rd.solve(patches, rd.Method(order=order), quanta=20_000, replicates=2)
        assert all(np.array_equal(narrow.state[name], wide.state[name]) for name in narrow.state)
        assert np.array_equal(narrow.irradiance, wide.irradiance)


def test_wavefronts_in_parts_give_the_same_integers(monkeypatch):
    """A wavefront of very many lines is fired in parts, so that runs can be stopped in between."""
    from radiosity.algorithms.firing.orders import breadth_first
    from radiosity.tracing import parts

    patches, told = rd.subdivide(rd.load_scene("room"), cells=2), []
    monkeypatch.setitem(breadth_first.TAILS, "cpu", 0)
    whole = rd.solve(patches, rd.Method(), quanta=20_000, replicates=2)
    monkeypatch.setitem(parts.MOST, "cpu", (3_000, 3_000))
    fire = breadth_first.fire

    def remembered(counters, wavefront, largest):
        told.append(wavefront.total)
        fire(counters, wavefront, largest)

    monkeypatch.setattr(breadth_first, "fire", remembered)
    parted = rd.solve(patches, rd.Method(), quanta=20_000, replicates=2)
    assert all(np.array_equal(whole.state[name], parted.state[name]) for name in whole.state)
    assert max(told) < 3_400
    assert len(told) > 20


@pytest.mark.parametrize(
    ("rows", "threads", "firer", "rounds", "most"),
    [
        (5, 2, None, None, 1 << 24),
        (5, 16, None, None, 1 << 24),
        (5, 1, None, None, 1 << 23),
        (5, 1, None, "some", 1 << 24),  # where a part ends decides which lines make up packets, and so exact ties
        (3 << 20, 2, None, None, 3 << 23),
        (1 << 30, 2, None, None, 1 << 25),
        (1 << 30, 1, None, None, 1 << 24),
        (5, 1, SimpleNamespace(most=7), None, 7),
    ],
)
def test_wavefronts_last_some_seconds(rows, threads, firer, rounds, most, monkeypatch):
    """Those fired here are short, but for many rows, since each costs a pass over all of them. Others say what they can do."""
    from radiosity.algorithms.firing import due
    from radiosity.tracing import parts

    monkeypatch.setattr(parts, "dr", SimpleNamespace(thread_count=lambda: threads))
    tracer = SimpleNamespace(geometry=SimpleNamespace(device=SimpleNamespace(name="cpu")))
    assert due._most(SimpleNamespace(tracer=tracer, firer=firer, rounds=rounds, total=rows)) == most


def test_powers_of_bands_go_on_beyond_64_bits(geometry):
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=1).solid
    geometry, problem = Geometry(patches, choose("cpu")), Problem.of(patches)
    run = algorithm(geometry, problem, {})
    grey, _ = near_the_border(problem, run)
    groups, unit = problem.groups, 2**31
    share = groups.emission * patches.area[:, None] / problem.source.power
    received = np.round(grey.arrivals[..., None] * share.sum(axis=0) * 2.0**20).astype(np.int64).astype(object) * (unit >> 20)
    fired_of = np.where(problem.source.share > 0, grey.fired, grey.quanta)[
        ..., None
    ]  # what the lamp has fired, of what it must fire
    owed = share * (fired_of * 2.0**20) + groups.reflectance * (received / 2**11).astype(float)
    sent = np.floor(owed).astype(np.int64).astype(object) * (unit >> 20)
    missed = np.stack([sent.sum(axis=1) - received.sum(axis=1), np.zeros((2, groups.n_groups), object)])
    assert (missed >= 0).all()
    assert (sent >= 2**64).any()

    def of_words(power):
        return (power % 2**64).astype(np.uint64), (power // 2**64).astype(np.uint32)

    received, missed, sent, fired = (of_words(x) for x in (received, missed, sent, sent.sum(axis=1).T))
    names = ("received", "received_missed", "sent", "fired_power")
    pairs = dict(zip(names, (received, missed, sent, fired), strict=True))
    words = {name: low for name, (low, _) in pairs.items()} | {f"{name}_upper": upper for name, (_, upper) in pairs.items()}
    begin = replace(grey, bands=BandState(sizes=run.sizes, within=True, **words))
    run.restore(begin)
    run.advance(begin.quanta, nobody)
    end = run.capture()
    assert end.bands.received_upper.any()
    assert all(run.tally.books(problem, end, group)["closes"] is True for group in range(groups.n_groups))
    again = run.read({name: np.array(value) for name, value in begin.arrays().items()}, run.sizes)
    other, told = algorithm(geometry, problem, {}), []

    def stop(lines):
        told.append(lines)
        if len(told) == 2:
            raise InterruptedError

    other.restore(again)
    with pytest.raises(InterruptedError):
        other.advance(begin.quanta, stop)
    rest = algorithm(geometry, problem, {})
    rest.restore(other.read(other.capture().arrays(), other.sizes))
    rest.advance(begin.quanta, nobody)
    for name, value in rest.capture().arrays().items():
        assert np.array_equal(value, end.arrays()[name]), name


def test_states_of_both_widths_are_merged(geometry, problem):
    sizes = replace(algorithm(geometry, problem, {}, replicates=1).sizes, groups=2)
    n, zero = sizes.rows, np.zeros((1, sizes.rows, 2), np.uint64)
    few, many = np.full((1, n), 7, np.uint32), np.full((1, n), 2**40, np.uint64)
    missed, power = np.zeros((2, 1, 2), np.uint64), np.full((2, 1), 2**63, np.uint64)
    words = {"received": zero, "received_missed": missed, "sent": zero, "fired_power": power}
    parts_of_a_run = [
        FiringState(sizes=sizes, quanta=9, arrivals=few, fired=few, missed=few[:, :2].T, bands=BandState(sizes=sizes, **words)),
        FiringState(
            sizes=sizes,
            quanta=9,
            arrivals=many,
            fired=many,
            missed=many[:, :2].T,
            bands=BandState(sizes=sizes, **words, received_upper=np.ones((1, n, 2), np.uint32)),
        ),
    ]
    whole = merge(parts_of_a_run)
    assert whole.arrivals.tolist() == [[7] * n, [2**40] * n]
    assert whole.missed.tolist() == [[7, 2**40]] * 2
    assert whole.bands.received_upper[:, 0, 0].tolist() == [0, 1]
    assert whole.bands.sent_upper is None
    assert whole.bands.exact("received") == 2 * n << 64


def test_power_of_walks_is_added_beyond_64_bits():
    sizes = Sizes(1, 3, 1)
    counts, power = np.zeros((1, 3), np.uint32), np.array([2**63 + 1], np.uint64)
    state = WalkState(sizes=sizes, quanta=9, arrivals=counts, missed=counts[:, :2].T, fired_power=power)
    whole = merge([state, state, state])
    assert whole.fired_in_all == [3 * (2**63 + 1)]
    assert merge([whole, state]).fired_in_all == [4 * (2**63 + 1)]


WALKS = [
    {"equation": "continuous", "order": "breadth-first"},
    pytest.param({"estimator": "absorption"}, marks=pytest.mark.slow),
    pytest.param({"absorption": "fractional"}, marks=pytest.mark.slow),
    pytest.param({"estimator": "gathering", "order": "breadth-first"}, marks=pytest.mark.slow),
]


def of_walks(geometry, problem, method, quanta, state=None):
    run = algorithm(geometry, problem, method, replicates=1)
    if state is not None:
        run.restore(run.read(state.arrays(), run.sizes))
    run.advance(quanta, nobody)
    return run


@pytest.mark.parametrize("method", WALKS)
def test_walks_cross_the_border(geometry, problem, method):
    """Walks from one N to another are those of two runs that meet at the border, and others than the first walks."""
    zero = algorithm(geometry, problem, method, replicates=1)
    share, empty = zero.source_sampling.source.share.max(), zero.capture()
    begin, end = round((2**32 - 100) / share), round((2**32 + 400) / share)
    once = of_walks(geometry, problem, method, end, replace(empty, quanta=begin)).capture()
    middle = of_walks(geometry, problem, method, round((2**32 - 1) / share), replace(empty, quanta=begin)).capture()
    twice = of_walks(geometry, problem, method, end, middle).capture()
    assert np.array_equal(once.arrivals, twice.arrivals)
    assert np.array_equal(once.missed, twice.missed)
    lines = once.arrivals.sum() + once.missed.sum()
    assert lines > end - begin  # walks go on
    first = of_walks(geometry, problem, method, end - round(2**32 / share)).capture()  # walks of the same low words
    assert not np.array_equal(first.arrivals, twice.arrivals - middle.arrivals)


SOME_SLOW = [pytest.param("global", marks=pytest.mark.slow), "spans", pytest.param("bundles", marks=pytest.mark.slow)]


@pytest.mark.parametrize("kind", SOME_SLOW)
def test_global_lines_cross_the_border(geometry, kind):
    spans = Spans(geometry, Method(lines=kind, order="matrix"), 3, 2)
    each = spans.bundle if kind == "bundles" else 1
    border = (2**32 - 1) * each  # the number of the first line of the second block, counted from 0 on
    both, one = spans.draw(1, border - each, 2 * each), spans.draw(1, border - each, each)
    other = spans.draw(1, border, each)
    assert np.array_equal(both.one, np.append(one.one, other.one))
    assert np.array_equal(both.line, np.append(one.line, other.line + np.uint32(each)))
    assert not np.array_equal(spans.draw(1, border, 64 * each).one, spans.draw(1, 0, 64 * each).one)


def test_iterations_fire_lines_beyond_the_border(geometry):
    shooter = Shooter(geometry, Method(), 4, 1, 1)
    n, types = len(geometry.patches), geometry.device.types
    fired = np.full((1, n), 2**32 - 11, np.uint64)
    fired[0, 1] = 2**34 - 3
    shooter.sequences.begin_after(fired)
    counts = np.arange(n, dtype=np.uint32) * 5
    assert shooter.shoot(upload(types.UInt32, counts), upload(types.Int, np.full(n, 3, np.int32))) == counts.sum()
    arrivals, after, missed, _ = shooter.read()
    assert np.array_equal(after[0], fired[0] + counts)
    expected = np.zeros(n + 2, np.int64)
    for row in range(n):
        for block, begin, more in parts(fired[:, row], counts[row : row + 1]):
            expected += traced(shooter.tracer, row, (int(begin[0]) + 1) % BLOCK, int(more[0]), block)
    assert np.array_equal(np.append(arrivals[0], missed[:, 0]), expected)
    assert np.array_equal(frozen(shooter.scores.received)[:n], 3 * arrivals[0])


@pytest.mark.slow
def test_incremental_stages_of_very_many_quanta(geometry, problem, monkeypatch):
    """They send their power in parts, and keep sums in double precision; a run that was stopped between parts goes on alike."""
    from radiosity.algorithms.iterations import incremental

    patches = geometry.patches
    usual = rd.solve(patches, rd.Method(order="incremental"), quanta=40_000, replicates=4)
    monkeypatch.setattr(incremental, "MOST", 7_000)
    monkeypatch.setattr(incremental, "EXACT", 20_000)
    parted = rd.solve(patches, rd.Method(order="incremental"), quanta=40_000, replicates=4)
    assert parted.state["received"].dtype == np.float64
    assert parted.irradiance == pytest.approx(usual.irradiance, rel=0.1)
    assert not np.array_equal(parted.irradiance, usual.irradiance)
    run, told = algorithm(geometry, problem, {"order": "incremental"}), []

    def stop(lines):
        told.append(lines)
        if len(told) == 9:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        run.advance(40_000, stop)
    rest, whole = (algorithm(geometry, problem, {"order": "incremental"}) for _ in range(2))
    state = run.read(run.capture().arrays(), run.sizes)
    assert state.unfinished
    rest.restore(state)
    for one in (rest, whole):
        one.advance(40_000, nobody)
    assert np.array_equal(rest.capture().incremental.received, whole.capture().incremental.received)


def test_gathers_cross_the_border(geometry, problem):
    run = make(geometry, problem, PRESETS["gather"].method, 5, 2)
    run.advance(4000, nobody)
    lines, count = run._lines, run.packets.count
    done, few, many = np.full(count, 2**32 - 5), np.full(count, 4), np.full(count, 9)
    above = np.full(count, 2**32 - 1), many - few  # its index wraps around to 0
    read = [upload(lines.types.Float, np.random.default_rng(1).random(run.packets.lanes, np.float32))]
    cosine = lines._cosine(lines.numbers.streams[0].words(1), *above, read, None, None, squares=False)[0]
    shadow = lines._shadow(lines.numbers.streams[1].words(1), *above, None, squares=False)
    for both, below, rest in (
        (lines.cosine(done, many, read)[0], lines.cosine(done, few, read)[0], cosine),
        (lines.shadow(done, many), lines.shadow(done, few), shadow),
    ):
        assert frozen(rest[0]).any()
        assert np.array_equal(frozen(both[0]), frozen(below[0]) + frozen(rest[0]))


def test_sums_of_lanes_are_set_apart(geometry):
    packets, types = Packets(geometry, 2), geometry.device.types
    for kind, sign in ((types.UInt64, 1), (types.Int64, -1)):
        sums, total = Sums(packets, kind, 1), 0
        for step in range(5):
            value = sign * (2**62 // 3 + step)
            sums.add([dr.full(kind, value, packets.lanes)])
            total += value
            if step == 2:
                sums.set_apart()
        assert np.allclose(frozen(sums.about()[0]), total, rtol=1e-15)
        words, upper = sums.read()
        assert int(words[1, 3, 0]) + (int(upper[1, 3, 0]) << 64) == total
        again = Sums(packets, kind, 1)
        again.write(words, upper)
        assert np.array_equal(frozen(again.about()[0]), frozen(sums.about()[0]))


def test_pairs_are_counted_beyond_32_bits():
    keys = np.array([3, 7, 9], np.uint64)
    counts = PairCounts(keys, np.array([2**32 - 1, 5, 6], np.uint32))
    counts.add(np.zeros(3, np.int64), np.array([3, 3, 9]))
    assert counts.arrays[1].tolist() == [2**32 + 1, 5, 7]
    counts = PairCounts(keys, np.array([2**32 - 3, 2**31, 6], np.uint32))
    counts.add(np.zeros(1, np.int64), np.array([3]))
    assert counts.arrays[1].dtype == np.uint32


def test_no_number_of_lines_is_too_large():
    for budget in (Budget(rays=1e15), Budget(quanta=2**50), Budget(error=0.01)):
        budget.check(8)
    at = Progressed(2**40, 2**43, 10.0, 1.0, 0.02)
    assert next_quanta(Budget(quanta=2**50), 8, 1024, at, replay=False) == 2**41
    assert next_quanta(Budget(error=0.01), 8, 1024, at, replay=False) == 2**41
    assert next_quanta(Budget(error=0.01), 8, 1024, replace(at, error=np.nan), replay=False) is None
    assert next_quanta(Budget(error=0.01, rays=10**15), 8, 1024, replace(at, error=np.nan), replay=False) == 2**41


def test_sums_of_global_lines_that_are_full_end_a_run(monkeypatch):
    """What was traced is kept, and the status says what to do; sums that wrapped around would be wrong without a word."""
    patches, options = rd.subdivide(rd.load_scene("room"), cells=1), {"replicates": 2, "seed": 1}
    method = rd.Method(lines="global", order="regular")
    whole = rd.solve(patches, method, quanta=2**17, **options)
    monkeypatch.setattr(pooling, "FULL", int(whole.state["received"].max()) // 3)
    ended = rd.solve(patches, method, quanta=2**20, **options)
    assert "global lines are full" in ended.status
    assert 0 < ended.quanta < 2**20
    assert (ended.irradiance == rd.solve(patches, method, quanta=ended.quanta, **options).irradiance).all()
