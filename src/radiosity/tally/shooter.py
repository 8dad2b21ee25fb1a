"""The shooter: patch i fires c_i lines that carry given weights. Iterations are made of it.

The k-th line of a patch is a function of (seed, replicate, patch, k), and k counts over the whole run (contract 2). Numbers of
patches and slots are those of `LineTracer`. A shot may be fired in parts: they bring what all lines at once would.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import frozen
from ..device.launches import shared
from ..errors import MethodError
from ..method import Method
from ..patches.bases import CONSTANT, Basis
from ..problem.lights import AbstractLights
from ..sampling.blocks import BLOCK
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry
from ..tracing.lanes import Batch, Launch, sums
from ..tracing.line_tracer import LineTracer
from ..tracing.parts import most_lines, part
from ..tracing.spots import traced
from .hit_counts import HitCounts
from .hit_tally import DENSE
from .scores import Ends, Load, Receivers, Scores
from .sequences import Sequences
from .shots import Shots, shoot_elsewhere
from .wraps import PERIOD

FEW = 1 << 13  # batches of at most this many lines share one kernel

Pairs = Callable[[np.ndarray, np.ndarray], None]


@dataclass(frozen=True)
class Begun:
    """A shot that is fired in parts, after some of them.

    Attributes:
        done: (total,) UInt32, lines of each patch number that were fired in it.
        received, moved: as of `Scores`, what they brought.
    """

    done: Any
    received: Any
    moved: Any = None

    @property
    def sizes(self) -> tuple[int, int]:
        """The numbers of entries of ``received`` and ``moved``."""
        return dr.width(self.received), 0 if self.moved is None else dr.width(self.moved)


class Shooter:
    """Fires lines of patches, and of lights without area after them.

    Attributes:
        hits: the hit counts.
        sequences: the lines that were fired in each sequence of points.
        scores: the power that lines of the last shot brought.
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
        tracer = LineTracer.of(geometry, method.points, method.randomisation, seed, replicates, lights)
        self.types, self.total, self.slots = tracer.types, tracer.total, tracer.slots
        self.hits, self.sequences = HitCounts(tracer), Sequences(tracer, sequences)
        self.scores = Scores(tracer.types, tracer.total, tracer.slots, n_groups, basis)
        self.elsewhere: Shots | None = None
        self.told: Callable[[int], None] | None = None
        self.begun: Begun | None = None
        self._unseen = 0  # lines since counters were looked at

    @property
    def tracer(self) -> LineTracer:
        """Lines of the patches, of the sequence that is taken now."""
        return self.sequences.tracer

    def _look(self) -> None:
        """Note which counters wrapped around."""
        self.hits.look()
        self.sequences.look()
        self._unseen = 0

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
            weights, ends, receivers: what lines carry, see `Load`.
            pairs: called for every launch with patch numbers and the slots that their lines hit, (m,) uint32 each; the
                arrays are valid until it returns.
        """
        total, left, load = 0, counts, Load(weights, ends, receivers)
        if self.begun is None:
            self.scores.begin(load)
        else:
            left = self._go_on(self.begun, counts, load)
            (total,) = sums(self.types, self.begun.done)
        while left is not None:
            lines, left = self._shoot(left, load, pairs)
            total += lines
            if left is not None and self.told is not None:
                self.begun = Begun(counts - left, self.scores.received, self.scores.moved)
                dr.eval(self.begun.done)
                self.told(lines)
        self.begun = None
        return total

    def _go_on(self, begun: Begun, counts, load: Load):
        """Take what a shot that had begun brought, and return the lines that are left of it."""
        if begun.sizes != self.scores.sizes(load) or dr.any(begun.done > counts):
            other = "the solution to go on from has lines of another step"
            raise MethodError(f"{other}; take an earlier checkpoint, or start anew")
        self.scores.received, self.scores.moved = begun.received, begun.moved
        return counts - begun.done

    def _shoot(self, counts, load: Load, pairs: Pairs | None) -> tuple[int, Any]:
        """Fire lines of each patch that lie in one block, or a part of them.

        Return their number, and the counts of those that are left, or None.
        """
        types, tracer, upper = self.types, self.tracer, self.sequences.upper
        dr.eval(counts, load.weights)
        rows: Any = dr.compress(counts > 0)
        if dr.width(rows) == 0:
            return 0, None
        now, fired = dr.gather(types.UInt32, counts, rows), dr.gather(types.UInt32, self.sequences.fired, rows)
        if self.elsewhere is not None and pairs is None and load.receivers is None and upper.halves is None:
            (lines,) = sums(types, now)
            if lines >= self.elsewhere.least:
                return self._shoot_elsewhere(self.elsewhere, lines, counts, rows, now, load)
        largest, blocks, left = dr.max(now + fired), None, None
        if upper.halves is not None:
            first = fired + 1
            blocks = upper.upper(fired, rows) + dr.select(first == 0, types.UInt32(1), types.UInt32(0))
            now = dr.minimum(now, dr.select(first == 0, types.UInt32(PERIOD), dr.minimum(0 - first, PERIOD)))
            left, largest = counts - self._spread(now, rows), dr.full(types.UInt32, BLOCK - 1, 2)
            tracer.blocks.prepare(upper.largest + 1)
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
            self._fire(launch, 32 if batch.total <= FEW else bits, load, pairs, mode)
            self._unseen += launch.lanes
            if self._unseen > PERIOD:
                self._look()
        dr.scatter(self.sequences.fired, batch.fired + batch.counts, batch.numbers, active=batch.counts > 0)
        dr.eval(self.sequences.fired, left)
        return batch.total, left if left is not None and dr.any(left > 0) else None

    def _shoot_elsewhere(self, elsewhere: Shots, lines: int, counts, rows, now, load: Load) -> tuple[int, Any]:
        """Have lines of these rows, or a part of them, fired elsewhere; return what `_shoot` does."""
        left = None
        if self.told is not None and lines > elsewhere.most:
            now = part(self.types, now, elsewhere.most / lines)
            left = counts - self._spread(now, rows)
        lines = shoot_elsewhere(self, elsewhere, rows, now, load)
        dr.eval(left)
        self._look()
        return lines, left

    def _spread(self, values, rows):
        """Return values of some patch numbers as an array of all."""
        found = dr.zeros(self.types.UInt32, self.total)
        dr.scatter(found, values, rows)
        dr.eval(found)
        return found

    def _fire(self, launch: Launch, bits: int, load: Load, pairs: Pairs | None, mode: dr.ReduceMode) -> None:
        types, tracer, scores = self.types, self.tracer, self.scores
        (number, index, record), block = launch.read(types), launch.block(types)
        real = launch.mask(types)
        if scores.basis.size > 1:
            lines = traced(tracer, number, index, record, bits, block)
            landed = lines[0]
            scores.add_moments(load, number, lines, real, mode)
        else:
            landed = tracer.trace(number, index, record, bits, block)
            scores.add(load, number, landed, real, mode)
        self.hits.add(landed, real, mode)
        if pairs is not None:
            dr.schedule(number, landed)
        with shared(launch.lanes):
            dr.eval(self.hits.arrivals, scores.received, scores.moved)
        if pairs is not None:
            pairs(frozen(number)[: launch.lanes], frozen(landed)[: launch.lanes])

    def read(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray | None]:
        """Copy the counts to the host.

        Returns:
            Arrivals and fired, (replicates, n_patches); missed, (2, replicates); and where there are several sequences, lines
            fired in each, (sequences, replicates, n_patches), else None. ``fired`` is the sum over sequences. All are uint32
            where that suffices, else uint64.
        """
        arrivals, missed = self.hits.read()
        fired, apart = self.sequences.read()
        return arrivals, fired, missed, apart

    def write(self, arrivals: np.ndarray, fired: np.ndarray, missed: np.ndarray, apart: np.ndarray | None) -> None:
        """Set the counts to what `read` returned."""
        self.hits.write(arrivals, missed)
        self.sequences.write(fired, apart)
