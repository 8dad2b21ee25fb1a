"""Which lines are traced in packets: whole rounds of boxes, each packet of one patch and one box, and every line once."""

from types import SimpleNamespace

import numpy as np
import pytest

import radiosity as rd
from radiosity.device.backend import choose, upload
from radiosity.sampling.numbers import strata
from radiosity.tracing import lanes, rounds
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.line_tracer import LineTracer

TYPES = choose("cpu").types
MANY = 2**32


def split(counts, fired, own: int, sizes=strata.SIZES, blocks=None, small=None) -> list[lanes.Batch]:
    """The batches that some lines are cut into."""
    counts, fired, numbers = (
        upload(TYPES.UInt32, np.asarray(column, np.uint32)) for column in (counts, fired, np.arange(len(counts)))
    )

    def records(rows):
        return rows, rows

    blocks = None if blocks is None else upload(TYPES.UInt32, np.asarray(blocks, np.uint32))
    small = None if small is None else upload(TYPES.Bool, np.asarray(small, bool))
    batch = lanes.Batch.of(TYPES, numbers, counts, fired, records, blocks=blocks)
    tracer = SimpleNamespace(types=TYPES, own_lines=own, record=records, row=lambda number: number)
    return rounds.Rounds(sizes, small).split(tracer, batch, (3, 2, 1))


def fired_in(batch: lanes.Batch, begin: int = 0, end: int | None = None) -> tuple[np.ndarray, np.ndarray]:
    """The patch and the index of every line of a batch: (turns, lanes), 16 lanes in a row for each packet."""
    patches, indices = [], []
    for launch in batch.launches(TYPES, begin, end):
        number, first, _ = launch.read(TYPES)
        lines, each = np.asarray(launch.lines(TYPES, first)), int(batch.each[0]) if batch.several else 1
        if batch.boxes is None:
            turns = np.asarray(first).astype(np.int64) + np.arange(each)[:, None]
            turns[np.arange(each)[:, None] >= lines] = -1
        else:
            index = batch.boxes.turns(TYPES, first, launch.rank)
            turns = np.stack([np.asarray(index(TYPES.UInt32(turn))) for turn in range(each)]).astype(np.int64)
            assert (lines == each).all()
        indices.append(turns)
        patches.append(np.broadcast_to(np.asarray(number), turns.shape))
    return np.concatenate(patches, axis=1), np.concatenate(indices, axis=1)


@pytest.mark.parametrize("own", [0, 1 << 15, 1 << 20])
def test_every_line_is_fired_once_and_packets_hold_lines_of_one_box(own, random, monkeypatch):
    monkeypatch.setattr(rounds, "LEAST", 1)
    counts = np.concatenate([random.integers(0, 400_000, 9), random.integers(0, 6_000, 40), [0, 1, 2304, 331_776]])
    fired = random.integers(0, 60_000, len(counts))
    if own:  # a round before the border, and a line less
        counts, fired = np.append(counts, [2304, 2304]), np.append(fired, [own - 2304, own - 2303])
    made = split(counts, fired, own)
    assert sum(part.boxes is not None for part in made) > 3
    found = []
    for part in made:
        patch, index = fired_in(part)
        if part.boxes is not None:
            size = next(size for size in strata.SIZES if strata.boxes(*size) == int(part.boxes.count[0]))
            for one, what in ((patch, "patch"), (index % strata.boxes(*size), "box"), (index <= own, "side of the border")):
                packets = one.reshape(len(one), -1, strata.PACKET)
                assert (packets == packets[..., :1]).all(), what
        real = index >= 0
        found.append(patch[real].astype(np.int64) * MANY + index[real])
    wanted = [
        np.arange(1, count + 1) + before + row * MANY for row, (before, count) in enumerate(zip(fired, counts, strict=True))
    ]
    assert np.array_equal(np.sort(np.concatenate(found)), np.concatenate(wanted))


def test_few_lines_are_left_over():
    """Of half a million lines of each patch less than a round of the smallest boxes, on either side of the border."""
    counts, own = np.full(32, 500_000), 1 << 16
    rest = [part for part in split(counts, np.full(32, 1000), own) if part.boxes is None]
    assert len(rest) == 1
    left = np.asarray(rest[0].counts)
    assert (left < 2 * strata.lines(*strata.SIZES[0])).all()


def test_the_border_is_that_of_the_first_block_alone():
    """In later blocks all lines of a patch have one randomisation, so a round may hold lines on both sides of its place."""
    counts, own, size = np.full(2, strata.lines(7, 3)), 1 << 15, ((7, 3),)
    assert [part.boxes is not None for part in split(counts, [0, 0], own, size)] == [False]
    assert [part.boxes is not None for part in split(counts, [0, 0], own, size, [1, 1])] == [True]
    assert [part.boxes is not None for part in split(counts, [0, 0], own, size, [0, 1])] == [False]  # one of two: too few


def test_too_few_lines_stay_as_they_are():
    few = rounds.LEAST // 2 // 2304 * 2304
    for counts in ([few, 3], [2303] * 300):
        (part,) = split(counts, [7] * len(counts), 0)
        assert part.boxes is None


@pytest.mark.parametrize("size", [(4, 2), (8, 4)])
def test_a_patch_may_fire_more_lines_than_single_precision_counts(size):
    """2^31 of them: quotients of lines by lines of a lane are beyond it."""
    counts = np.full(2, (1 << 31) // strata.lines(*size) * strata.lines(*size))
    (part,) = split(counts, [12_345, 77], 0, (size,))
    for begin in (part.total // 2 - (1 << 16), part.total - (1 << 16)):
        patch, index = fired_in(part, begin, begin + (1 << 16))
        assert len(np.unique(patch.astype(np.int64) * MANY + index)) == index.size
        packets = (index % strata.boxes(*size)).reshape(len(index), -1, strata.PACKET)
        assert (packets == packets[..., :1]).all()


def test_large_patches_are_left_out():
    """Their lines are left over, all of them and once."""
    counts = [100_000, 100_000, 100_000]
    made = split(counts, [5, 5, 5], 1 << 12, small=[True, False, True])
    fired = sum(np.asarray(part.counts).astype(int) for part in made if part.boxes is not None)
    assert fired[1] == 0
    assert (fired[[0, 2]] > 90_000).all()
    assert np.array_equal(sum(np.asarray(part.counts).astype(int) for part in made), counts)


def test_boxes_that_see_too_many_faces_do_not_pay():
    """A floor of many equal tiles needs finer boxes; things beside walls do not count."""
    floor, tiles = [[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0]], np.mgrid[:150, :150, 1:2].reshape(3, -1).T * [0.02, 0.02, 1]
    corners = tiles[:, None] + [[0, 0, 0], [0.01, 0, 0], [0.01, 0.01, 0], [0, 0.01, 0]]

    def patches(*quads):
        vertices = np.concatenate([np.reshape(quad, (-1, 3)) for quad in quads])
        return rd.subdivide(rd.Scene.from_arrays(vertices, np.arange(len(vertices)).reshape(-1, 4), 0.5, 1.0), cells=1)

    def found(of, fewest=0):
        found = rounds.Rounds.of(LineTracer.of(Geometry(of, choose("cpu")), "halton", "by-patch", 0, 1), fewest)
        assert found is not None
        return found

    large, small, alone = found(patches(floor)), found(patches(floor, corners)), found(patches(corners))
    assert large.sizes == small.sizes == strata.SIZES
    assert alone.sizes == tuple(s for s in strata.SIZES if strata.boxes(*s) * rounds.FACES >= 22_500)
    assert found(patches(floor), 50_000).sizes == ((7, 3), (8, 3), (8, 4))
    assert large.small is None
    assert np.array_equal(np.flatnonzero(~np.asarray(small.small)), [0])  # its lines pass beside all the tiles
