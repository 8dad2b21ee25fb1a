"""The shooter: patch i fires c_i lines that carry given weights. Iterations are made of it.

The k-th line of a patch is a function of (seed, replicate, patch, k), and k counts over the whole run (contract 2). Where there
are several sequences, each counts its own lines and has its own points, independent of the others. Received power is summed in
64-bit fixed point, so no sum depends on an order or on threads. Numbers of patches and slots are those of `LineTracer`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import frozen, upload
from ..device.launches import shared
from ..errors import MethodError
from ..method import Method
from ..patches.bases import CONSTANT, Basis
from ..problem.lights import AbstractLights
from ..sampling.blocks import BLOCK
from ..sampling.streams import Purpose, Seed
from ..tracing.geometry import Geometry
from ..tracing.lanes import Batch, Launch, sums
from ..tracing.line_tracer import LineTracer
from ..tracing.parts import most_lines, part
from ..tracing.spots import traced
from .hit_counts import HitCounts
from .hit_tally import DENSE
from .moments import Moments
from .shots import Shots, shoot_elsewhere
from .wraps import PERIOD, Wraps

FEW = 1 << 13  # batches of at most this many lines share one kernel

Pairs = Callable[[np.ndarray, np.ndarray], None]


@dataclass(frozen=True)
class Ends:
    """The score at both ends of a line from i to j: ``carried_i`` / (``density_i`` + ``density_j``) at j.

    The score at i is ``carried_j`` over the same sum.

    Attributes:
        density: (slots,) Float, expected lines of each patch by its area, any unit; positive where it fires; 0 behind patches.
        carried: (slots * n_columns,) Float, the power by area, in fixed point units times the unit of density; 0 behind patches.
        groups: how many groups of bands it has; None: those of the shooter.
    """

    density: Any
    carried: Any
    groups: int | None = None


@dataclass(frozen=True)
class Receivers:
    """Slots that receive what lines bring, where these are not those that lines hit.

    Attributes:
        size: the number of slots, those of the tracer first.
        of: called in kernels with the patch number that sends and the slot that a line hit: the slot that receives.
    """

    size: int
    of: Callable[[Any, Any], Any]


@dataclass(frozen=True)
class Begun:
    """A shot that is fired in parts, after some of them.

    Attributes:
        done: (total,) UInt32, lines of each patch number that were fired in it.
        received, moved: as of `Shooter`, what they brought.
    """

    done: Any
    received: Any
    moved: Any = None

    @property
    def sizes(self) -> tuple[int, int]:
        """The numbers of entries of ``received`` and ``moved``."""
        return dr.width(self.received), 0 if self.moved is None else dr.width(self.moved)


class Shooter:
    """Counters of lines of patches, and of lights without area after them, and the kernel that fires them.

    Attributes:
        tracer: lines of the patches, with the numbers of the sequence that is taken now.
        hits: the hit counts.
        fired: UInt32 (total,), lines of each patch in that sequence, modulo 2^32; ``upper`` has the upper words.
        basis: of the light on patches.
        received: (slots * n_columns,) Int64, power of the last shot; of all receivers where it had them. A slot has a column for
            each group of bands, or with a basis of K functions K columns for each: the power times each function, summed.
        moved: (slots * n_columns,) Int64, what of the last shot with receivers other slots received than those that lines hit, by
            the slots that they hit.
        elsewhere: fires many lines elsewhere; None: here.
        told: is called with the number of its lines after each part of a shot but the last; None: shots are fired whole.
        begun: the shot of which a part has been fired; the next one goes on with it.
    """

    def __init__(
        self,
        geometry: Geometry,
        method: Method,
        seed: Seed | int,
        replicates: int,
        n_groups: int,
        sequences: int = 1,
        basis: Basis = CONSTANT,
        lights: AbstractLights | None = None,
    ):
        self.tracer = tracer = LineTracer.of(geometry, method.points, method.randomisation, seed, replicates, lights)
        self.types, self.total, self.slots, self.groups = tracer.types, tracer.total, tracer.slots, n_groups
        self.hits, self.basis = HitCounts(tracer), basis
        self.received = dr.opaque(self.types.Int64, 0, self.slots * n_groups * basis.size) if n_groups else None
        self.moved: Any = None
        self.sequence, self.unseen = 0, 0  # unseen: lines since counters were looked at
        self._tracers = [tracer, *(tracer.of_stream(Purpose.SEQUENCE, more) for more in range(1, sequences))]
        self._fired = [dr.opaque(self.types.UInt32, 0, self.total) for _ in range(sequences)]
        self._upper = [Wraps(self.types) for _ in range(sequences)]
        self.fired = self._fired[0]
        self.elsewhere: Shots | None = None
        self.told: Callable[[int], None] | None = None
        self.begun: Begun | None = None

    @property
    def sequences(self) -> int:
        """How many there are."""
        return len(self._fired)

    def take(self, sequence: int) -> None:
        """Use this sequence for the next lines."""
        self._fired[self.sequence] = self.fired
        self.fired, self.tracer = self._fired[sequence], self._tracers[sequence]
        self.sequence = sequence

    @property
    def upper(self) -> Wraps:
        """Upper words of ``fired``."""
        return self._upper[self.sequence]

    def _look(self) -> None:
        """Note which counters wrapped around."""
        self.hits.look()
        self.take(self.sequence)
        for upper, fired in zip(self._upper, self._fired, strict=True):
            upper.look(fired)
        self.unseen = 0

    def shoot(
        self,
        counts,
        weights=None,
        ends: Ends | None = None,
        pairs: Pairs | None = None,
        receivers: Receivers | None = None,
    ) -> int:
        """Fire lines, and return their number, that of lines of a shot that had begun included.

        Args:
            counts: (total,) UInt32, lines that each patch number fires now.
            weights: (total * n_groups,) Int32 or Int64, what each line of a patch number adds to the slot that it hits; with a
                basis of more functions (total * n_columns,) Float, the coefficients of a polynomial.
            ends: what lines add at both ends, in place of ``weights``.
            pairs: called for every launch with patch numbers and the slots that their lines hit, (m,) uint32 each; the
                arrays are valid until it returns.
            receivers: what receives, where it is not what lines hit; without polynomials.
        """
        total, left, begun = 0, counts, self.begun
        groups = self.groups if ends is None or ends.groups is None else ends.groups
        size = (self.slots if receivers is None else receivers.size) * groups * self.basis.size
        moved = self.slots * groups if receivers else 0
        if begun is not None:
            if begun.sizes != (size, moved) or dr.any(begun.done > counts):
                other = "the solution to go on from has lines of another step"
                raise MethodError(f"{other}; take an earlier checkpoint, or start anew")
            self.received, self.moved, left = begun.received, begun.moved, counts - begun.done
            (total,) = sums(self.types, begun.done)
        elif self.groups:
            self.received = dr.opaque(self.types.Int64, 0, size)
            self.moved = dr.opaque(self.types.Int64, 0, moved) if receivers else None
        while left is not None:
            lines, left = self._shoot(left, weights, ends, pairs, receivers)
            total += lines
            if left is not None and self.told is not None:
                self.begun = Begun(counts - left, self.received, self.moved)
                dr.eval(self.begun.done)
                self.told(lines)
        self.begun = None
        return total

    def _shoot(self, counts, weights, ends: Ends | None, pairs: Pairs | None, receivers: Receivers | None) -> tuple[int, Any]:
        """Fire lines of each patch that lie in one block, or a part of them.

        Return their number, and the counts of those that are left, or None.
        """
        types, tracer = self.types, self.tracer
        dr.eval(counts, weights)
        rows: Any = dr.compress(counts > 0)
        if dr.width(rows) == 0:
            return 0, None
        now, fired = dr.gather(types.UInt32, counts, rows), dr.gather(types.UInt32, self.fired, rows)
        if self.elsewhere is not None and pairs is None and receivers is None and self.upper.halves is None:
            (lines,) = sums(types, now)
            if lines >= self.elsewhere.least:
                left = None
                if self.told is not None and lines > self.elsewhere.most:
                    now = part(types, now, self.elsewhere.most / lines)
                    left = counts - self._spread(now, rows)
                lines = shoot_elsewhere(self, self.elsewhere, rows, now, weights, ends)
                dr.eval(left)
                self._look()
                return lines, left
        largest, blocks, left = dr.max(now + fired), None, None
        if self.upper.halves is not None:
            first = fired + 1
            blocks = self.upper.upper(fired, rows) + dr.select(first == 0, types.UInt32(1), types.UInt32(0))
            now = dr.minimum(now, dr.select(first == 0, types.UInt32(PERIOD), dr.minimum(0 - first, PERIOD)))
            left, largest = counts - self._spread(now, rows), dr.full(types.UInt32, BLOCK - 1, 2)
            tracer.blocks.prepare(self.upper.largest + 1)
        batch = Batch.of(types, rows, now, fired, tracer.record, blocks=blocks)
        most = most_lines(tracer.geometry.device.name, self.total)
        if self.told is not None and batch.total > most:  # to add lines up before the batch took 60 bytes more a row
            now = part(types, now, most / batch.total)
            left = counts - self._spread(now, rows)
            del batch
            batch = Batch.of(types, rows, now, fired, tracer.record, blocks=blocks)
        # read after the batch, whose size the host has waited for; batches of few lines share one kernel, whatever their indices
        bits = tracer.numbers.bits_for(int(largest[0]))
        mode = dr.ReduceMode.Expand if batch.total > DENSE * self.total else dr.ReduceMode.Direct
        for launch in batch.launches(types):
            self._fire(launch, 32 if batch.total <= FEW else bits, weights, ends, pairs, mode, receivers)
            self.unseen += launch.lanes
            if self.unseen > PERIOD:
                self._look()
        dr.scatter(self.fired, batch.fired + batch.counts, batch.numbers, active=batch.counts > 0)
        dr.eval(self.fired, left)
        return batch.total, left if left is not None and dr.any(left > 0) else None

    def _spread(self, values, rows):
        """Return values of some patch numbers as an array of all."""
        found = dr.zeros(self.types.UInt32, self.total)
        dr.scatter(found, values, rows)
        dr.eval(found)
        return found

    def _fire(self, launch: Launch, bits: int, weights, ends: Ends | None, pairs: Pairs | None, mode, receivers) -> None:
        types, tracer = self.types, self.tracer
        (number, index, record), block = launch.read(types), launch.block(types)
        real = launch.mask(types)
        if self.basis.size > 1:
            landed = self._fire_moments(traced(tracer, number, index, record, bits, block), number, weights, ends, real, mode)
        else:
            landed = tracer.trace(number, index, record, bits, block)
        self.hits.add(landed, real, mode)
        to, back_to = landed, number
        if receivers is not None:
            to = receivers.of(number, landed)
            if ends is not None:  # behind patches nothing sends back
                back_to = receivers.of(dr.select(landed < self.total, landed, number), number)
        for g in range(self.groups if self.basis.size == 1 else 0):
            here, there = number * self.groups + g, landed * self.groups + g
            gets, gets_back = to * self.groups + g, back_to * self.groups + g
            if ends is None:
                self._add(types.Int64(dr.gather(type(weights), weights, here)), gets, there, real, mode)
                continue
            both = dr.gather(types.Float, ends.density, number) + dr.gather(types.Float, ends.density, landed)
            forth, back = (dr.gather(types.Float, ends.carried, at) / both for at in (here, there))
            self._add(types.Int64(dr.round(forth)), gets, there, real, mode)
            self._add(types.Int64(dr.round(back)), gets_back, here, real, mode)
        if pairs is not None:
            dr.schedule(number, landed)
        with shared(launch.lanes):
            dr.eval(self.hits.arrivals, self.received, self.moved)
        if pairs is not None:
            pairs(frozen(number)[: launch.lanes], frozen(landed)[: launch.lanes])

    def _fire_moments(self, lines, number, weights, ends: Ends | None, real, mode):
        """Add what lines (see `traced`) bring to moments, and return the slots that they hit."""
        landed, begin, end = lines
        groups = self.groups if ends is None or ends.groups is None else ends.groups
        moments = Moments(self.basis, groups, self.total, self.types)

        def add(value, column, counts):
            self._add(value, column, column, real & counts, mode)

        if ends is None:
            moments.forth(weights, number, landed, begin, end, add)
        else:
            moments.both(ends, number, landed, begin, end, add)
        return landed

    def _add(self, value, index, hit, real, mode) -> None:
        """Add a power to what a column receives, and note it where a line hit another one."""
        dr.scatter_add(self.received, value, index, active=real, mode=mode)
        if self.moved is not None:
            dr.scatter_add(self.moved, value, hit, active=real & (index != hit), mode=mode)

    def read(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray | None]:
        """Copy the counts to the host.

        Returns:
            Arrivals and fired, (replicates, n_patches); missed, (2, replicates); and where there are several sequences,
            lines fired in each, (sequences, replicates, n_patches), else None. ``fired`` is the sum over sequences. All are
            uint32 where that suffices, else uint64.
        """
        arrivals, missed = self.hits.read()
        self.take(self.sequence)
        columns = [upper.values(low).reshape(arrivals.shape) for upper, low in zip(self._upper, self._fired, strict=True)]
        if len(columns) == 1:
            return arrivals, columns[0], missed, None
        apart = np.stack(columns)
        fired = apart.sum(axis=0, dtype=np.uint64)
        return arrivals, fired if int(fired.max()) >= BLOCK else fired.astype(np.uint32), missed, apart

    def write(self, arrivals: np.ndarray, fired: np.ndarray, missed: np.ndarray, apart: np.ndarray | None) -> None:
        """Set the counts to what `read` returned."""
        self.hits.write(arrivals, missed)
        columns = fired[None] if apart is None else apart
        self._fired = [upload(self.types.UInt32, upper.of(x)) for upper, x in zip(self._upper, columns, strict=True)]
        self.fired = self._fired[self.sequence]

    def begin_after(self, fired: np.ndarray) -> None:
        """Let the next lines follow the first ``fired`` ones of each patch, (replicates, n_patches)."""
        self.fired = self._fired[self.sequence] = upload(self.types.UInt32, self.upper.of(fired))
