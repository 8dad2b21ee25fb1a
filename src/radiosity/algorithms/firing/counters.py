"""The firing engine's integers: hit and fired counts of every source row and replicate, and the kernels that change them.

Rows, their numbers and slots are those of `LineTracer`. An order (`orders`) decides which row fires when.

Counters have 32 bits until one of them comes near their end. From then on the engine is wide: counters have upper words
(`tally.wraps`), target counts have 64 bits, and the lines that a row fires in a wavefront lie in one block of its numbers
(`sampling.blocks`). The integers are the same as they would be with wide counters from the start.
"""

from collections.abc import Iterator

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...device.launches import shared
from ...device.recorded import loop
from ...errors import MethodError
from ...method.model import Method
from ...problem.model import Problem
from ...problem.quanta import WORD, phases
from ...sampling.blocks import BLOCK
from ...sampling.streams import Seed
from ...tally.bands import BandTally
from ...tally.far_sides import FarSides
from ...tally.hit_counts import HitCounts
from ...tally.hit_tally import AbstractHitTally, hit_tally
from ...tally.wraps import PERIOD, Wraps
from ...tracing.coherent_costs import fewest_lines
from ...tracing.geometry import Geometry
from ...tracing.lanes import PIECE, Batch, Launch, Wavefront, boxes_for, sums
from ...tracing.line_tracer import LineTracer
from ..base import Interrupted
from .elsewhere import Firer, fire_elsewhere

MANY = 4  # after wavefronts of at least a line for 4 patches, all patches are looked through, and no flags are kept
FEW = 1 << 13  # up to this many lines, the host sorts the slots that they hit: that is faster than to look through all flags
# Lines of a wavefront of integers: a few seconds, after which a run can be stopped, or its checkpoint written.
MOST = {"cpu": 1 << 26, "cuda": 1 << 32}
# 8, 4 or 2 lines of a lane, in wavefronts of 250 000 lines a thread, once as many lines have been fired
SHIFTS, MUCH = (3, 2, 1), 250_000


class FiringCounters:
    """The hit, fired and target counts of all rows.

    Attributes:
        tracer: lines of the rows.
        problem: its ``rows`` and the scalar problem ``source``.
        hits: the hit counts.
        fired: UInt32 (total,), the fired count of each row, modulo 2^32; ``fired_upper`` has the upper words.
        phase: UInt32 (total,), the rounding offset of each row.
        panes: the far sides of diffusing panes, or None.
        quanta: N of the stage that began last.
        has_due: True where some row may still have to fire a line.
        firer: fires wavefronts elsewhere; None: here.
        parted: True where the last wavefront has a part of the lines that were due.
        wide: True where 32 bits may be too few for the next wavefront.
        unseen: at least the number of lines since counters were looked at.
    """

    def __init__(self, geometry: Geometry, problem: Problem, method: Method, seed: Seed | int, replicates: int):
        self.problem, self.source = problem, problem.source
        self.packets_from = fewest_lines(method, geometry.device.name)  # lines of a patch; None: no packets
        self.tracer = LineTracer.of(geometry, method.points, method.randomisation, seed, replicates, problem.lights)
        self.types, self.total = self.tracer.types, self.tracer.total
        u32 = self.types.UInt32
        self.rho = upload(u32, self.source.rho)
        self.panes = FarSides.of(self.tracer, self.source)
        self.phase = upload(u32, phases(seed, replicates, self.tracer.n))
        self.fired, self.fired_upper = dr.opaque(u32, 0, self.total), Wraps(self.types)
        rows = problem.rows
        self.bands = BandTally(self.tracer, rows, self.source) if rows.weighed else None
        self.hits = HitCounts(self.tracer, self.bands)
        self.hits.forget_touched()
        self.landed = None
        self.quanta = 0
        self.everywhere, self.has_due, self.wide = True, False, False
        self.swept = self.unseen = 0  # swept: lines of the wavefronts so far
        self.emits_much, self.whole_upper, self.parted = False, None, False
        self.firer: Firer | None = None  # where lines are fired elsewhere

    def set_quanta(self, quanta: int) -> None:
        """Begin a stage: N for each replicate; it may only grow."""
        if quanta < self.quanta:
            raise MethodError(f"quanta may only grow within a run ({self.quanta} to {quanta})")
        whole, fraction = self.source.emitted(quanta)
        self.whole, self.fraction = (upload(self.types.UInt32, a.astype(np.uint32, copy=False)) for a in (whole, fraction))
        much = whole.dtype.itemsize > 4
        self.whole_upper = upload(self.types.UInt32, (whole >> WORD).astype(np.uint32)) if much else None
        self.quanta, self.everywhere, self.has_due = quanta, True, True
        self.emits_much = much or int(whole.max()) >> 31 > 0
        self._widen()

    def look(self) -> None:
        """Note which counters wrapped around, and whether 32 bits suffice for the next wavefront."""
        self.hits.look()
        self.fired_upper.look(self.fired)
        if self.bands is not None:
            self.bands.look()
        self.unseen = 0
        self._widen()

    def _widen(self) -> None:
        grown = self.fired_upper.halves is not None or self.hits.upper.halves is not None
        self.wide = self.emits_much or grown
        if self.wide:
            self.tracer.blocks.prepare(self.fired_upper.largest + 1)

    def counters(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return hit and fired counts, (replicates, n), and escaped and lost lines, (2, replicates): uint32, or uint64."""
        arrivals, missed = self.hits.read()
        return arrivals, self.fired_upper.values(self.fired).reshape(arrivals.shape), missed

    @property
    def lines(self) -> int:
        """The number of lines fired so far."""
        lines = sums(self.types, self.fired)[0]
        if self.fired_upper.halves is None:
            return lines
        return lines + (sums(self.types, self.fired_upper.upper(self.fired))[0] << 32)

    # ---- lines that are due ----------------------------------------------------------------------------------------

    def candidates(self):
        """Return the numbers of the patches that may have to fire a line: those that lines hit since the last call.

        It is None for all patches: in a new stage, or where lines hit many of them.
        """
        types, numbers = self.types, None
        if self.landed is not None:
            numbers = np.unique(self.landed)
            numbers = numbers[numbers < self.total]
            numbers = numbers if self.panes is None else self.panes.with_others(numbers)
            numbers = upload(types.UInt32, _not_alone(numbers, self.total))
        elif not self.everywhere:
            if self.panes is not None:
                self.hits.touched = self.panes.spread(self.hits.touched)
            numbers = dr.compress(dr.reshape(types.Bool, self.hits.touched, self.total, shrink=True))  # no copy of the flags
        if self.landed is None:
            self.hits.forget_touched()
        self.everywhere, self.landed = False, None
        return numbers

    def target_counts(self, numbers, arrivals, hits=None):
        """Return the target counts of patch numbers (None: of all patches) after ``arrivals`` hits, UInt32.

        They are modulo 2^32, see `_wide_target_counts`.

        Args:
            hits: the hits of all numbers, from which those of the other sides of diffusing panes are taken; None: those of now.
        """
        u32, wide = self.types.UInt32, self.types.UInt64
        if numbers is None and self.tracer.replicates == 1:
            rho, whole, fraction = self.rho, self.whole, self.fraction
        else:
            number = dr.arange(u32, self.total) if numbers is None else numbers
            patch = number - self.tracer.replicate(number) * self.tracer.n_opaque
            rho, whole, fraction = (dr.gather(u32, column, patch) for column in (self.rho, self.whole, self.fraction))
        low = wide(rho) * wide(arrivals) + wide(fraction) + wide(self._read(self.phase, numbers))
        if self.panes is not None:
            low += self.panes.sent_on(numbers, self.hits.arrivals if hits is None else hits)
        return whole + u32(low >> 32)

    def _wide_target_counts(self, number, arrivals):
        """Return the target counts of patch numbers after ``arrivals`` hits, UInt64; in a kernel.

        A hit count of two words sends on rho times its upper word in whole lines.
        """
        u32, wide = self.types.UInt32, self.types.UInt64
        patch = number - self.tracer.replicate(number) * self.tracer.n_opaque
        whole, rho, fraction = (dr.gather(u32, column, patch) for column in (self.whole, self.rho, self.fraction))
        low = wide(rho) * wide(arrivals) + wide(fraction) + wide(self._read(self.phase, number))
        lines = wide(whole) + wide(rho) * wide(self.hits.upper.upper(arrivals, number))
        if self.whole_upper is not None:
            lines += wide(dr.gather(u32, self.whole_upper, patch)) << 32
        if self.panes is not None:
            tau, hits, beyond = self.panes.across(number, self.hits.arrivals)
            low += wide(tau) * wide(hits)
            lines += wide(tau) * wide(self.hits.upper.upper(hits, beyond))
        return lines + (low >> 32)

    def _wide_counts(self, number, arrivals):
        """Return how many lines patch numbers fire in a wide wavefront: `PERIOD` at most, all in one block; in a kernel."""
        u32, wide = self.types.UInt32, self.types.UInt64
        fired = self.fired_upper.whole(self._read(self.fired, number), number)
        left = wide(BLOCK) - ((fired + 1) & wide(BLOCK - 1))
        due = self._wide_target_counts(number, arrivals) - fired
        return u32(dr.minimum(dr.minimum(due, left), wide(PERIOD)))

    def blocks(self, numbers):
        """Return the blocks of the lines that patch numbers fire next; in a kernel."""
        u32, fired = self.types.UInt32, self._read(self.fired, numbers)
        return self.fired_upper.upper(fired, numbers) + dr.select(fired == u32(BLOCK - 1), u32(1), u32(0))

    def is_due_after(self, number, before, active):
        """Return whether one hit after ``before`` others raises the target count of a patch by one; called in a kernel.

        On diffusing panes it does not: a hit there may raise the counts of both sides, which the next wavefront finds.
        """
        u32, wide = self.types.UInt32, self.types.UInt64
        patch = number - self.tracer.replicate(number) * self.tracer.n_opaque
        rho = wide(dr.gather(u32, self.rho, patch, active))
        rest = wide(dr.gather(u32, self.fraction, patch, active)) + wide(dr.gather(u32, self.phase, number, active))
        low = rho * wide(before) + rest
        raised = ((low + rho) >> 32) > (low >> 32)
        return raised if self.panes is None else raised & ~self.panes.crosses(patch, active)

    def _read(self, column, numbers):
        """Return a column's values of patch numbers, or of all patches.

        All values are taken without a gather, in a third of the time where they are not in the cache.
        """
        if numbers is not None:
            return dr.gather(self.types.UInt32, column, numbers)
        return column if dr.width(column) == self.total else dr.reshape(self.types.UInt32, column, self.total, shrink=True)

    def due(self) -> tuple[Wavefront | None, int]:
        """Return the lines that are due now, and the largest line number among them."""
        numbers = self.candidates()
        wavefront, largest = self._sweep(numbers, 0, self.total if numbers is None else dr.width(numbers))
        self.has_due = wavefront is not None
        if not self.has_due and self.bands is not None:
            self.bands.rest()
        return wavefront, largest

    def look_everywhere(self) -> None:
        """Look through all rows at the next call of `due`."""
        self.everywhere, self.landed = True, None

    def due_between(self, low: int, high: int) -> tuple[Wavefront | None, int]:
        """Return the result of `due` for the patch numbers from ``low`` to below ``high``; in grey scenes only."""
        return self._sweep(None, low, high - low)

    def _sweep(self, numbers, low: int, size: int) -> tuple[Wavefront | None, int]:
        """Return the wavefront of patch numbers (None: of ``size`` patches from ``low`` on), and its largest line number.

        With bands, all patches are taken in pieces, to save memory, and hit counts are kept in place of counts of lines.
        """
        u32, counts, wide = self.types.UInt32, None, self.wide
        total, largest = dr.opaque(self.types.UInt64, 0, 2), dr.opaque(u32, 0, 2)
        keep = self.bands is None or size <= PIECE or wide
        step = PIECE if numbers is None and self.bands is not None and not wide else max(size, 1)
        for start in range(0, size, step):
            width = min(step, size - start)
            places = dr.arange(u32, width) + dr.opaque(u32, start)
            piece = places + dr.opaque(u32, low) if numbers is None else numbers
            read = None if numbers is None and width == self.total and not wide else piece
            arrivals = self._read(self.hits.arrivals, read)
            counts = self._count(read, arrivals, total, largest)
            dr.eval(total, largest, *([counts] if keep else []), *([arrivals] if self.bands is not None else []))
            if self.bands is not None:
                self.bands.weigh(self, piece, places, arrivals, counts)
        lines = int(total[0])
        self.parted = self.bands is None and lines > MOST[self.tracer.geometry.device.name]
        if not lines:
            return None, 0
        if self.parted:
            counts, lines = self._part(counts, lines)
        blocks = self.blocks if wide else None
        return Wavefront(numbers, low, size, lines, counts if keep else None, blocks), int(largest[0])

    def _part(self, counts, lines: int):
        """Return counts of a part of all lines, and their number: what is left is due in the next wavefront."""
        share = dr.opaque(self.types.Float64, MOST[self.tracer.geometry.device.name] / lines)
        some = dr.minimum(self.types.UInt32(self.types.Float64(counts) * share) + 1, counts)
        dr.eval(some)
        return some, sums(self.types, some)[0]

    def _count(self, numbers, arrivals, total, largest):
        """Return how many lines patch numbers must fire now, and update their sum and the largest line number; in a kernel."""
        types, none = self.types, dr.zeros(self.types.UInt32, dr.width(arrivals))
        if self.wide:
            counts, target_counts = self._wide_counts(numbers, arrivals), dr.full(types.UInt32, BLOCK - 1, dr.width(arrivals))
        else:
            target_counts = self.target_counts(numbers, arrivals)
            counts = target_counts - self._read(self.fired, numbers)
        dr.scatter_add(total, types.UInt64(counts), none, mode=dr.ReduceMode.Expand)
        dr.scatter_reduce(dr.ReduceOp.Max, largest, target_counts, none, mode=dr.ReduceMode.Expand)
        return counts

    # ---- firing ----------------------------------------------------------------------------------------------------

    def fire(self, wavefront: Wavefront, largest: int) -> None:
        """Trace all lines of a wavefront and count their hits.

        Raises:
            Interrupted: they were fired elsewhere, and the run is to end; the counters are whole.
        """
        if self.firer is not None and wavefront.total >= self.firer.least:
            fire_elsewhere(self, wavefront, largest, self.firer)
            if self.firer.over:
                raise Interrupted("interrupted")
            return
        types = self.types
        bits = self.tracer.numbers.bits_for(largest)
        few = wavefront.total <= FEW and wavefront.blocks is None
        everywhere = wavefront.blocks is not None or self.parted or (not few and MANY * wavefront.total >= self.total)
        tally, landed = hit_tally(self.hits, wavefront.total, flags=not few and not everywhere), []
        for batch in self.batches(wavefront, () if few else self._shifts(wavefront)):
            boxes = None if self.packets_from is None else boxes_for(types, batch.counts, self.packets_from)
            if boxes is not None and batch.several:
                batch = batch.one_by_one(types, self.tracer.record)
            for launch in batch.launches(types):
                places = self._fire(launch, 32 if few else bits, boxes, few, tally)
                if few:
                    landed.append(frozen(places)[: launch.lanes])
                self.unseen += launch.lanes << (max(SHIFTS) if batch.several else 0)
                if self.unseen > PERIOD:
                    tally.settle()
                    self.look()
                    tally = hit_tally(self.hits, wavefront.total, flags=not few and not everywhere)
            dr.scatter(self.fired, batch.fired + batch.counts, batch.numbers, active=batch.counts > 0)
            if self.bands is not None:
                self.bands.count_fired(self, batch)
            dr.eval(self.fired)
        tally.settle()
        self.swept += wavefront.total
        self.everywhere, self.landed = everywhere, np.concatenate(landed) if few else None

    def batches(self, wavefront: Wavefront, shifts: tuple[int, ...] = ()) -> Iterator[Batch]:
        """Yield the batches of a wavefront, with 2^shift lines a lane."""
        return wavefront.batches(self.types, self.target_counts_before, self.fired, self.tracer.record, shifts)

    def target_counts_before(self, numbers):
        """Return the target counts of patch numbers when the wavefront was fixed, from the hit counts that bands keep.

        It is for wavefronts that keep no counts.
        """
        assert self.bands is not None
        before = self.bands.arrivals_before
        return self.target_counts(numbers, dr.gather(self.types.UInt32, before, numbers), before)

    def _shifts(self, wavefront: Wavefront) -> tuple[int, ...]:
        """Return the binary logarithms of the lines of a lane; () for one line a lane.

        What the lines of a patch have in common is then found once for all of them. It needs one more kernel, which takes time to
        compile, so short runs do not use it. It leaves fewer lanes, so many threads, and a GPU even more, do not use it.
        """
        cpu = self.tracer.geometry.device.name == "cpu"
        many = cpu and min(wavefront.total, self.swept) >= MUCH * dr.thread_count()
        return SHIFTS if many else ()

    def _fire(self, launch: Launch, bits: int, boxes, few: bool, tally: AbstractHitTally):
        """Trace the lines of one launch. Return the slots that they hit where there are few lines."""
        types, tracer = self.types, self.tracer
        number, first, record = launch.read(types, boxes)
        replicate = tracer.replicate_or_none(number)
        lines = tracer.leave(record)
        powers = [] if self.bands is None else self.bands.carried(types, launch)
        block = launch.block(types)

        def fire(numbers, active):
            landed = tracer.land_in(lines(numbers), replicate, boxes is not None, active)
            tally.add(landed, powers, active)
            return landed

        def turn_by_turn(turn):
            fire(points(turn), True)
            return (turn + 1,)

        landed = None
        if not launch.batch.several:
            landed = fire(tracer.points(number, first, replicate, record, bits, block), launch.mask(types, always=few))
        else:
            points = tracer.points_in_turn(first, number, replicate, record, bits, 1 << max(SHIFTS), block)
            count = launch.lines(types, first)
            loop((types.UInt32(0),), lambda turn: turn < count, turn_by_turn)
        if few:
            dr.schedule(landed)
        with shared(launch.lanes):
            dr.eval(*tally.arrays())
        return landed


def _not_alone(numbers: np.ndarray, total: int) -> np.ndarray:
    """Append another patch to a single one: arrays of one entry would compile kernels of their own."""
    if len(numbers) == 1 and total > 1:
        return np.append(numbers, (numbers[0] + 1) % total).astype(np.uint32)
    return numbers
