"""The lanes of launches: which patch fires in which lane, and which of its lines. A lane has one line, or a few."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import drjit as dr

from .boxes import Boxes

CHUNK = 1 << 20  # lanes of one launch on a CPU: enough to keep all cores busy, and little memory to touch
CORE_CHUNK = 1 << 18  # lanes for each core where cores are many: launches wait for the last one (measured on 4 to 16 cores)
CUDA_CHUNK = 1 << 24  # lanes of one launch on a GPU, which runs many more lanes at a time, and has memory for them
PIECE = 1 << 18  # patches of a batch: memory is needed for the patches of one batch, not for all of them at a time


@dataclass(frozen=True)
class Wavefront:
    """Lines that are traced together. They are fixed before the first is fired, so the pieces they are fired in do not matter.

    Attributes:
        numbers: UInt32, patch numbers; None where they are those from ``low`` on.
        low, size: the first patch number, and how many patches there are.
        total: lines of all patches.
        counts: UInt32, lines of each patch; None where bands keep what they follow from, see `FiringCounters.batches`.
        blocks: gives the block of the lines that patch numbers fire next (`sampling.blocks`); None where that is the first.
    """

    numbers: Any
    low: int
    size: int
    total: int
    counts: Any = None
    blocks: Callable[[Any], Any] | None = None

    def batches(self, types, target_counts, fired, records, shifts: tuple[int, ...] = ()) -> "Iterator[Batch]":
        """Yield a batch at a time, with as many lines a lane as `Batch.filled` chooses.

        Args:
            shifts: what it chooses from.
            target_counts: gives the target counts of patch numbers. fired: UInt32, the fired count of each patch.
            records: gives two words for patch numbers.

        The caller fires no other lines than the batches' until the last batch is made.
        """
        low = dr.opaque(types.UInt32, self.low)
        for start in range(0, self.size, PIECE):
            width = min(PIECE, few_sizes(self.size - start))
            first = dr.opaque(types.UInt32, start)
            place = dr.arange(types.UInt32, width) + first
            inside = place < dr.opaque(types.UInt32, self.size)
            at = dr.select(inside, place, 0)
            numbers = at + low if self.numbers is None else dr.gather(types.UInt32, self.numbers, at)
            before = dr.gather(types.UInt32, fired, numbers)
            counts = target_counts(numbers) - before if self.counts is None else dr.gather(types.UInt32, self.counts, at)
            counts = dr.select(inside, counts, 0)
            dr.schedule(counts, before)
            blocks = None if self.blocks is None else self.blocks(numbers)
            if self.size <= PIECE and not shifts:  # then the number of lines is known: the host does not wait for it
                yield Batch.of(types, numbers, counts, before, records, first, total=self.total, blocks=blocks)
                continue
            batch = Batch.filled(types, numbers, counts, before, records, first, shifts, blocks)
            if batch is not None:
                yield batch


@dataclass(frozen=True)
class Batch:
    """Patches that fire in a launch or several: a piece of a wavefront.

    Attributes:
        numbers: UInt32, patch numbers.
        counts: UInt32, lines that each patch fires now; may be zero.
        lanes: UInt32, lanes of each patch.
        begins: UInt64, lanes of all patches before it.
        fired: UInt32, lines that each patch has fired before, modulo 2^32.
        entries: UInt32, four words a patch, all that a lane reads: the number; the offset that maps a lane to its first line of
            the patch (fired + 1 - begins * each; 32-bit arithmetic wraps around, and the sum is right); and the patch's
            record, see `Geometry.patch_records`.
        start: where the piece begins in its wavefront, on the device.
        total: lanes of all patches.
        each: lines of a lane; the last lane of a patch takes what is left. 1, or UInt32, which gives one kernel for all sizes.
        blocks: UInt32, the block that holds all the lines which each patch fires now; None where that is the first.
        boxes: the order of the lines of each patch, which are whole rounds, traced in packets (`rounds`); None: as counted.
    """

    numbers: Any
    counts: Any
    lanes: Any
    begins: Any
    fired: Any
    entries: Any
    start: Any
    total: int
    each: Any
    blocks: Any = None
    boxes: Boxes | None = None

    @staticmethod
    def of(
        types,
        numbers,
        counts,
        fired,
        records,
        start=0,
        shift: int = 0,
        total: int | None = None,
        blocks: Any = None,
        boxes: Boxes | None = None,
    ) -> "Batch":
        """Make a batch of one or more patches.

        Args:
            counts, fired, blocks: UInt32, lines that each patch fires now, and has fired before, and their block.
            records: gives two words for patch numbers.
            shift: a lane has 2^shift lines.
            total: lanes of all patches, where it is known.
            boxes: an order of lines; only where there are two or more patches.
        """
        if dr.width(numbers) == 1:
            both = paired(types, dr.arange(types.UInt32, 1))
            numbers, counts, fired = (dr.gather(types.UInt32, column, both) for column in (numbers, counts, fired))
            blocks = None if blocks is None else dr.gather(types.UInt32, blocks, both)
            counts = dr.select(dr.arange(types.UInt32, 2) == 0, counts, 0)
        lanes = lanes_of(counts, dr.opaque(types.UInt32, shift)) if shift else counts
        each = dr.opaque(types.UInt32, 1 << shift) if shift else 1
        dr.eval(counts, lanes, fired, blocks)
        begins = dr.prefix_sum(types.UInt64(lanes))
        face, place = records(numbers)
        entries = dr.ravel(types.Array4u(numbers, fired + 1 - types.UInt32(begins) * each, face, place))
        dr.eval(begins, entries)
        last = dr.width(counts) - 1
        total = int(begins[last]) + int(lanes[last]) if total is None else total
        return Batch(numbers, counts, lanes, begins, fired, entries, start, total, each, blocks, boxes)

    @staticmethod
    def filled(
        types, numbers, counts, fired, records, start=0, shifts: tuple[int, ...] = (), blocks: Any = None
    ) -> "Batch | None":
        """Make a batch of 2^shift lines a lane: the largest of ``shifts`` that leaves few lanes half empty, else one line.

        It returns None where there are no lines. Other arguments: see `of`.
        """
        lines, *lanes = sums(types, counts, *(lanes_of(counts, shift) for shift in shifts))
        if not lines:
            return None
        shift, total = fullest(lines, {0: lines, **dict(zip(shifts, lanes, strict=True))})
        return Batch.of(types, numbers, counts, fired, records, start, shift, total, blocks)

    @property
    def several(self) -> bool:
        """True where a lane has more than one line."""
        return not isinstance(self.each, int)

    def launches(self, types, begin: int = 0, end: int | None = None, limit: int | None = None) -> "Iterator[Launch]":
        """Yield launches of a bounded number of lanes: a multiple of `chunk`, whatever the number of threads.

        Args:
            begin, end: the first lane, and the one after the last; all by default.
            limit: most lanes of a launch; fewer than a chunk where that is a power of two.
        """
        whole, cuda = chunk(types), dr.backend_v(types.UInt32) is dr.JitBackend.CUDA
        most = whole if cuda else max(1, CORE_CHUNK * dr.thread_count() // whole) * whole
        most = most if limit is None else min(most, limit)
        stop = self.total if end is None else min(end, self.total)
        for start in range(begin, stop, most):
            width = min(most, stop - start)
            # no literals: one kernel for all
            first, last = (dr.opaque(types.UInt64, at) for at in (start, start + width))
            # each entry writes its rank where its lanes begin; the running maximum carries it to all of them
            rank = dr.zeros(types.UInt32, few_sizes(width))
            here = (self.lanes > 0) & (self.begins < last) & (self.begins + types.UInt64(self.lanes) > first)
            at = types.UInt32(dr.maximum(self.begins, first) - first)
            dr.scatter(rank, dr.arange(types.UInt32, dr.width(self.numbers)), at, active=here)
            rank = dr.block_prefix_reduce(dr.ReduceOp.Max, rank, dr.width(rank), exclusive=False)
            dr.eval(rank)
            rank = dr.reshape(types.UInt32, rank, max(width, 2), shrink=True)
            yield Launch(self, rank, first, last, width, max(width, 2))


def chunk(types) -> int:
    """Return the lanes of a chunk, in which states count: launches have whole ones, on any number of threads."""
    return CUDA_CHUNK if dr.backend_v(types.UInt32) is dr.JitBackend.CUDA else CHUNK


def lanes_of(counts, shift):
    """Return the lanes of 2^shift lines that ``counts`` lines need."""
    whole = counts >> shift
    return whole + dr.select(whole << shift == counts, type(counts)(0), 1)


def fullest(lines: int, lanes: dict[int, int]) -> tuple[int, int]:
    """Return the largest shift whose lanes are filled to two thirds or more, and its number of lanes.

    Args:
        lanes: the number of lanes for each shift, of 2^shift lines a lane.
    """
    return max((shift, count) for shift, count in lanes.items() if 2 * count << shift <= 3 * lines)


def paired(types, rows):
    """Return the indices; a single one is repeated, since arrays of one entry would compile kernels of their own."""
    if dr.width(rows) != 1:
        return rows
    return dr.gather(types.UInt32, rows, dr.zeros(types.UInt32, 2) + dr.opaque(types.UInt32, 0))


@dataclass(frozen=True)
class Launch:
    """The lanes of one launch: the rank of each lane's patch in its batch.

    A single lane has a second one beside it that holds no line: ``lanes`` is then less than ``width``, and code that counts
    must ask `real`.
    """

    batch: Batch
    rank: Any
    first: Any
    end: Any
    lanes: int
    width: int

    def real(self, types):
        """Return a mask of the lanes that hold lines."""
        return types.UInt64(dr.arange(types.UInt32, self.width)) + self.first < self.end

    def read(self, types):
        """Return patch number, index of the first line, and patch record of each lane; called in a kernel of this width.

        Indices are counted from 1 on, modulo 2^32, see `block`.
        """
        batch = self.batch
        number, ahead, face, place = dr.gather(types.Array4u, batch.entries, self.rank)
        index = (dr.arange(types.UInt32, self.width) + types.UInt32(self.first)) * batch.each + ahead
        return number, index, (face, place)

    def block(self, types):
        """Return the block of each lane's lines; None where all are in the first one. Called in a kernel."""
        return None if self.batch.blocks is None else dr.gather(types.UInt32, self.batch.blocks, self.rank)

    def mask(self, types, *, always: bool = False):
        """Return which lanes hold lines, or True where all do, unless ``always``; called in a kernel."""
        return self.real(types) if always or self.lanes < self.width else True

    def lines(self, types, first):
        """Return how many lines each lane fires, from the index of its first line; called in a kernel."""
        fired, count = (dr.gather(types.UInt32, column, self.rank) for column in (self.batch.fired, self.batch.counts))
        lines = dr.minimum(fired + count + 1 - first, self.batch.each)
        return dr.select(self.mask(types), lines, 0)


def few_sizes(size: int) -> int:
    """Round a size up to one of four sizes an octave, since Dr.Jit gives freed memory to arrays of the same size alone."""
    step = 1 << max((size - 1).bit_length() - 3, 1)
    return -(-size // step) * step


def sums(types, *columns) -> tuple[int, ...]:
    """Return the sum of each column of 32-bit numbers, in 64 bits. (``dr.sum`` would store the columns widened first.)"""
    total = dr.opaque(types.UInt64, 0, max(len(columns), 2))
    for i, column in enumerate(columns):
        dr.scatter_add(total, types.UInt64(column), dr.full(types.UInt32, i, dr.width(column)), mode=dr.ReduceMode.Expand)
    dr.eval(total)
    return tuple(int(total[i]) for i in range(len(columns)))
