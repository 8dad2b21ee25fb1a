"""The quantum firing engine: integer counters of every patch and replicate on a device, and the kernels that move them.

Patch i of replicate r has number r * n_patches + i in every array: replicates go through the same kernels as extra
patches. After the patches, ``arrivals`` has two slots a replicate: lines escaped, and lines lost on absorbing backs.
"""

from collections.abc import Iterator

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...device.launches import shared
from ...device.recorded import loop
from ...errors import MethodError
from ...method.model import Method
from ...problem.bands import BandGroups, BandTally
from ...problem.quanta import LIMIT, Source, phases
from ...sampling.numbers import ready
from ...sampling.streams import Purpose, stream
from ...tally.landings import DENSE, AbstractLandings, landings
from ...tracing.departure import place_number
from ...tracing.geometry import Geometry
from ...tracing.lanes import PIECE, Batch, Chunk, Sweep, boxes_for, sums
from ...tracing.lines import land, local_line, local_lines, patch_of

MANY = 4  # at least one in so many patches was landed on: all are looked through
FEW = 1 << 13  # lines whose landing places are sorted out on the host, sooner than all flags are looked through
SHIFTS, MUCH = (3, 2, 1), 250_000  # 8, 4 or 2 lines of a lane, in sweeps of so many lines a thread after as many
ESCAPED, LOST = 0xFFFFFFFD, 0xFFFFFFFC  # no patch has these numbers


class Engine:
    """Counters and kernels. What fires when is the business of an order."""

    def __init__(
        self, geometry: Geometry, source: Source, method: Method, seed: int, replicates: int, groups: BandGroups | None = None
    ):
        self.geometry, self.source, self.method, self.seed = geometry, source, method, seed
        self.n, self.replicates = len(geometry.patches), replicates
        self.total = self.n * replicates
        if self.total + 2 * replicates > 2**31:
            raise MethodError(f"{self.n} patches times {replicates} replicates are too many to count; take fewer of either")
        self.types = geometry.device.types
        self.numbers = ready(method.points, self.types)
        u32 = self.types.UInt32
        self.rho = upload(u32, self.source.rho)
        self.phase = upload(u32, phases(seed, replicates, self.n))
        drawn = [self.numbers.randomisation(stream(seed, r, Purpose.NUMBERS)) for r in range(replicates)]
        self.randomisation = upload(u32, np.array(drawn, np.uint32))
        width = self.total + 2 * replicates
        self.arrivals, self.fired = dr.opaque(u32, 0, width), dr.opaque(u32, 0, self.total)
        self.touched, self.landed = dr.opaque(self.types.Bool, False, width), None
        self.n_opaque, self.magic = dr.opaque(u32, self.n), dr.opaque(u32, (2**32 - 1) // self.n)
        self.by_patch, self.own_lines = method.randomisation == "by-patch", dr.opaque(u32, own_lines(self.n))
        self.quanta = 0
        self.everywhere, self.owes = True, False
        self.swept = 0  # lines of the sweeps so far
        self.bands = BandTally(self, groups) if groups is not None and groups.n_groups > 1 else None

    def set_quanta(self, quanta: int) -> None:
        """Begin a stage: N for each replicate; it may only grow."""
        if quanta < self.quanta:
            raise MethodError(f"quanta may only grow within a run ({self.quanta} to {quanta})")
        whole, fraction = self.source.emitted(quanta)
        self.whole, self.fraction = (upload(self.types.UInt32, a) for a in (whole, fraction))
        self.quanta, self.everywhere, self.owes = quanta, True, True

    def counters(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Arrivals and fired lines, (replicates, n_patches) uint32, and escaped and lost lines, (2, replicates)."""
        flat, fired = frozen(self.arrivals), frozen(self.fired)
        arrivals = flat[: self.total].reshape(self.replicates, self.n)
        return arrivals, fired.reshape(self.replicates, self.n), flat[self.total :].reshape(2, self.replicates)

    @property
    def lines(self) -> int:
        """Fired so far."""
        return sums(self.types, self.fired)[0]

    # ---- what is owed ----------------------------------------------------------------------------------------------

    def candidates(self):
        """Numbers of the patches that may owe a line, those a line landed on since the last call; None for all: in a new stage,
        or where lines landed on many."""
        types, numbers = self.types, None
        if self.landed is not None:
            numbers = np.unique(self.landed)
            numbers = upload(types.UInt32, _not_alone(numbers[numbers < self.total], self.total))
        elif not self.everywhere:
            touched = dr.reshape(types.Bool, self.touched, self.total, shrink=True)  # as they lie: no copy
            if MANY * sums(types, dr.select(touched, types.UInt32(1), types.UInt32(0)))[0] < self.total:
                numbers = dr.compress(touched)
        if self.landed is None:
            self.touched = dr.opaque(types.Bool, False, self.total + 2 * self.replicates)
        self.everywhere, self.landed = False, None
        return numbers

    def owed(self, numbers, arrivals):
        """UInt32: lines that each of the patch numbers (None: all of them) owes in all after so many arrivals."""
        u32, wide = self.types.UInt32, self.types.UInt64
        if numbers is None and self.replicates == 1:
            rho, whole, fraction = self.rho, self.whole, self.fraction
        else:
            number = dr.arange(u32, self.total) if numbers is None else numbers
            patch = number - self.replicate(number) * self.n_opaque
            rho, whole, fraction = (dr.gather(u32, column, patch) for column in (self.rho, self.whole, self.fraction))
        low = wide(rho) * wide(arrivals) + wide(fraction) + wide(self._read(self.phase, numbers))
        return whole + u32(low >> 32)

    def _read(self, column, numbers):
        """A column's values of patch numbers, or of all. These are read as they lie: in a third of the time that it takes to
        gather them, where they are not in the cache."""
        if numbers is not None:
            return dr.gather(self.types.UInt32, column, numbers)
        return column if dr.width(column) == self.total else dr.reshape(self.types.UInt32, column, self.total, shrink=True)

    def due(self) -> tuple[Sweep | None, int]:
        """What is owed now, and the largest line number among it."""
        numbers = self.candidates()
        sweep, largest = self._sweep(numbers, 0, self.total if numbers is None else dr.width(numbers))
        self.owes = sweep is not None
        if not self.owes and self.bands is not None:
            self.bands.rest()
        return sweep, largest

    def due_between(self, low: int, high: int) -> tuple[Sweep | None, int]:
        """As `due`, of the patch numbers from ``low`` to below ``high`` alone; in grey scenes only."""
        return self._sweep(None, low, high - low)

    def _sweep(self, numbers, low: int, size: int) -> tuple[Sweep | None, int]:
        """Of patch numbers, or of so many from ``low`` on. Bands go through all of them in pieces, for the sake of memory, and
        keep arrivals in place of counts."""
        u32, counts = self.types.UInt32, None
        total, largest = dr.opaque(self.types.UInt64, 0, 2), dr.opaque(u32, 0, 2)
        step = PIECE if numbers is None and self.bands is not None else max(size, 1)
        keep = self.bands is None or size <= PIECE
        for start in range(0, size, step):
            width = min(step, size - start)
            places = dr.arange(u32, width) + dr.opaque(u32, start)
            piece = places + dr.opaque(u32, low) if numbers is None else numbers
            read = None if numbers is None and width == self.total else piece
            arrivals = self._read(self.arrivals, read)
            counts = self._count(read, arrivals, total, largest)
            dr.eval(total, largest, *([counts] if keep else []), *([arrivals] if self.bands is not None else []))
            if self.bands is not None:
                self.bands.weigh(self, piece, places, arrivals, counts)
        lines = int(total[0])
        return (Sweep(numbers, low, size, lines, counts if keep else None), int(largest[0])) if lines else (None, 0)

    def _count(self, numbers, arrivals, total, largest):
        """In a kernel: what patch numbers owe now; its sum, and the largest line number."""
        types, owed = self.types, self.owed(numbers, arrivals)
        counts, none = owed - self._read(self.fired, numbers), dr.zeros(types.UInt32, dr.width(arrivals))
        dr.scatter_add(total, types.UInt64(counts), none, mode=dr.ReduceMode.Expand)
        dr.scatter_reduce(dr.ReduceOp.Max, largest, owed, none, mode=dr.ReduceMode.Expand)
        return counts

    def record(self, number):
        """Face and place of a patch number, see `Geometry.patch_records`."""
        patch = number - self.replicate(number) * self.n_opaque
        return dr.gather(self.types.Array2u, self.geometry.patch_records, patch)

    def replicate(self, number):
        """Of a patch number: its quotient by n_patches, from a product by the reciprocal that is one short at most."""
        quotient = dr.mul_hi(number, self.magic)
        return quotient + dr.select(
            number - quotient * self.n_opaque >= self.n_opaque, self.types.UInt32(1), self.types.UInt32(0)
        )

    # ---- firing ----------------------------------------------------------------------------------------------------

    def fire(self, sweep: Sweep, largest: int) -> None:
        """Trace all lines of a sweep and count where they land."""
        types = self.types
        bits = self.numbers.bits_for(largest)
        few, everywhere = sweep.total <= FEW, sweep.total > DENSE * self.total
        tally, landed = landings(self, sweep.total, flags=not few and not everywhere), []
        for batch in self.batches(sweep, () if few else self._shifts(sweep)):
            boxes = boxes_for(types, batch.counts) if self.method.coherent else None
            for chunk in batch.chunks(types):
                places = self._fire(chunk, 32 if few else bits, boxes, few, tally)
                if few:
                    landed.append(frozen(places)[: chunk.lanes])
            dr.scatter(self.fired, batch.fired + batch.counts, batch.numbers, active=batch.counts > 0)
            if self.bands is not None:
                self.bands.count_fired(self, batch)
            dr.eval(self.fired)
        tally.settle()
        self.swept += sweep.total
        self.everywhere, self.landed = everywhere, np.concatenate(landed) if few else None

    def batches(self, sweep: Sweep, shifts: tuple[int, ...] = ()) -> Iterator[Batch]:
        """Of a sweep, of 2^shift lines a lane."""
        return sweep.batches(self.types, self._owed_before, self.fired, self.record, shifts)

    def _owed_before(self, numbers):
        """Lines that patch numbers owed in all when the sweep was fixed, where it keeps no counts: bands know."""
        assert self.bands is not None
        return self.owed(numbers, dr.gather(self.types.UInt32, self.bands.arrivals_before, numbers))

    def _shifts(self, sweep: Sweep) -> tuple[int, ...]:
        """Lines of a lane: what those of a patch have in common is found once for all of them. It takes a kernel more to compile,
        which short runs do without; many threads, and a GPU more so, want more lanes than that would leave."""
        cpu = self.geometry.device.name == "cpu"
        many = cpu and not self.method.coherent and min(sweep.total, self.swept) >= MUCH * dr.thread_count()
        return SHIFTS if many else ()

    def _fire(self, chunk: Chunk, bits: int, boxes, few: bool, tally: AbstractLandings):
        """One launch. Of few lines, the slots they land in."""
        types = self.types
        number, first, record = chunk.read(types, boxes)
        replicate = self._replicate(number)
        lines = local_lines(self.geometry, record)
        powers = [] if self.bands is None else self.bands.carried(types, chunk)

        def fire(numbers, active):
            landed = self._land(*lines(numbers), replicate, boxes is not None, active)
            tally.add(landed, powers, active)
            return landed

        def turn_by_turn(turn):
            fire(points(turn), True)
            return (turn + 1,)

        landed = None
        if not chunk.batch.several:
            landed = fire(self.points(number, first, replicate, record, bits), chunk.mask(types, always=few))
        else:
            points = self.numbers.in_turn(first, *self._stream(number, replicate, record), bits, 1 << max(SHIFTS))
            count = chunk.lines(types, first)
            loop((types.UInt32(0),), lambda turn: turn < count, turn_by_turn)
        if few:
            dr.schedule(landed)
        with shared(chunk.lanes):
            dr.eval(*tally.arrays())
        return landed

    def trace(self, number, index, record, bits: int):
        """Fire the ``index``-th line (from 1) of each patch number: the slot of ``arrivals`` where it lands."""
        replicate = self._replicate(number)
        points = self.points(number, index, replicate, record, bits)
        return self._land(*local_line(self.geometry, record, points), replicate, False, True)

    def _land(self, origin, direction, replicate, coherent: bool, active):
        return self.slot(land(self.geometry, origin, direction, coherent=coherent, active=active), replicate)

    def land_in(self, line, replicate, active):
        """The slot of ``arrivals`` where lines land, from their origins and directions."""
        origin, direction = line
        return self._land(origin, direction, replicate, False, active)

    def _replicate(self, number):
        return self.types.UInt32(0) if self.replicates == 1 else self.replicate(number)

    def points(self, number, index, replicate, record, bits: int):
        """The numbers of the ``index``-th line of each patch number, whose record it is."""
        patch, randomisation = self._stream(number, replicate, record)
        return self.numbers.points(index, patch, randomisation(index), bits)

    def _stream(self, number, replicate, record):
        """Patch, and its randomisation as a function of the index: its own for its first lines, then that of all patches."""
        types = self.types
        patch = number if self.replicates == 1 else number - replicate * self.n_opaque
        halves = [dr.gather(types.Array4u, self.randomisation, replicate * 2 + half) for half in (0, 1)]
        words = [word for half in halves for word in half]
        if not self.by_patch:
            return patch, lambda index: words
        place = place_number(record)
        return patch, lambda index: self.numbers.of_patch(words, dr.select(index <= self.own_lines, place, 0))

    def slot(self, hit, replicate):
        """The slot of ``arrivals`` for lines of a replicate, from where they land."""
        types = self.types
        landed = patch_of(self.geometry, hit, LOST, ESCAPED)
        slot = dr.select(landed == ESCAPED, types.UInt32(self.total), types.UInt32(self.total + self.replicates)) + replicate
        return dr.select(landed >= LOST, slot, landed + replicate * self.n_opaque)


def own_lines(n: int) -> int:
    """How many lines of a patch take its own randomisation: a power of two between twice and four times as many as there are
    patches. With more lines than that, one for all is as good for means over surfaces, and better for patches."""
    return min(1 << (4 * n).bit_length() - 1, LIMIT)


def _not_alone(numbers: np.ndarray, total: int) -> np.ndarray:
    """A single patch gets company that owes nothing: arrays of one entry would compile kernels of their own."""
    if len(numbers) == 1 and total > 1:
        return np.append(numbers, (numbers[0] + 1) % total).astype(np.uint32)
    return numbers
