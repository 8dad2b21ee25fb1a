"""Powers of bands that lines carry where bands differ (contract 3)."""

import functools
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import frozen, upload
from ..problem.bands import QUANTUM
from ..problem.quanta import Source
from ..problem.source_rows import SourceRows
from ..tracing.line_tracer import LineTracer
from .wraps import Wraps

MUCH = 1 << 26  # lanes of a batch, above which a sum of all their power could have more than 64 bits


class BandTally:
    """Power of each group of bands, in 64-bit fixed point, received by every patch and carried by its lines.

    A line carries, of each band, what its patch has not sent yet, divided by the real number of lines that it must still fire,
    not by the whole number that it fires. The power that this leaves on a patch is known, and `residue` sends it on. The groups
    of a patch are next to each other in memory, so that a hit writes to one place.

    Attributes:
        received: UInt64, group g of slot s (see `LineTracer`) at s * n_groups + g.
        sent: UInt64, what lines have carried away from patch number p, at p * n_groups + g.
        arrivals_before: UInt32, hits of patch numbers at the last wavefront; None between stages.
        fired: UInt64, power that left replicate r along lines since the last look, at g * replicates + r; ``fired_much`` has more
            of it, in 2^32 of its units, and ``fired_before`` what left before.
        upper: upper words of ``received`` by rows, ``received`` by other slots, and ``sent``, which are modulo 2^64.
        parted: True where a part of the last wavefront is left to fire.
        weights: UInt32, of group g, what each line of the i-th patch of a wavefront carries, at i * n_groups + g; None between
            stages.
    """

    def __init__(self, tracer: LineTracer, rows: SourceRows, source: Source):
        self.n = rows.emission.shape[1]
        types = tracer.types
        self.shares = [upload(types.Float64, rows.emission[:, g] * rows.area / source.power) for g in range(self.n)]
        self.lines = None if rows.lines is None else upload(types.Float64, source.share)
        self.rhos = [upload(types.UInt32, Source.fixed(rows.reflectance[:, g])) for g in range(self.n)]
        through = rows.through
        self.taus: Any = None if through is None else [upload(types.UInt32, Source.fixed(column)) for column in through.T]
        self.received = dr.opaque(types.UInt64, 0, tracer.slots * self.n)
        self.sent = dr.opaque(types.UInt64, 0, tracer.total * self.n)
        self.tracer, self.fired_before = tracer, [0] * (self.n * tracer.replicates)
        self._begin_fired()
        self.weights = self.arrivals_before = None
        self.parted = False
        self.upper = {name: Wraps(types, 64) for name in ("received", "missed", "sent")}

    def _begin_fired(self) -> None:
        self.fired, self.fired_much = (dr.opaque(self.tracer.types.UInt64, 0, len(self.fired_before)) for _ in range(2))

    @property
    def fired_in_all(self) -> list[int]:
        """Power that left replicate r along lines, at g * replicates + r."""
        parts = zip(self.fired_before, frozen(self.fired), frozen(self.fired_much), strict=True)
        return [before + int(low) + (int(much) << 32) for before, low, much in parts]

    def set_fired(self, low: np.ndarray, upper: np.ndarray | None) -> None:
        """Set the power that left along lines, from words of 64 bits."""
        above = [0] * len(low) if upper is None else np.ravel(upper)
        self.fired_before = [int(word) + (int(more) << 64) for word, more in zip(low, above, strict=True)]
        self._begin_fired()

    @property
    def columns(self) -> dict[str, Any]:
        """The low words of what ``upper`` names."""
        types, tracer, split = self.tracer.types, self.tracer, self.tracer.total * self.n
        at = dr.arange(types.UInt32, 2 * tracer.replicates * self.n) + dr.opaque(types.UInt32, split)
        missed = dr.gather(types.UInt64, self.received, at)
        rows = dr.reshape(types.UInt64, self.received, split, shrink=True)
        return {"received": rows, "missed": missed, "sent": self.sent}

    def look(self) -> None:
        """Note which sums wrapped around; called every `PERIOD` lines or more often."""
        for name, column in self.columns.items():
            self.upper[name].look(column)
        self.fired_before = self.fired_in_all
        self._begin_fired()

    def rest(self) -> None:
        """Free the arrays that only wavefronts use; called between stages."""
        self.weights = self.arrivals_before = None

    def weigh(self, counters, numbers, places, arrivals, counts) -> None:
        """Write what each line of the patches ``numbers`` carries, of each group, to ``places`` in ``weights``.

        It is called before a wavefront. It also adds what ``counts`` lines of each patch take away to ``sent``, and keeps the
        ``arrivals`` of now. No expression may still wait to read the arrays that are written here, or Dr.Jit copies them whole.
        """
        types = counters.types
        if self.weights is None:
            self.weights = dr.opaque(types.UInt32, 0, counters.total * self.n)
            self.arrivals_before = dr.opaque(types.UInt32, 0, counters.total)
        self._weigh(counters, numbers, places, arrivals)
        dr.eval(self.weights)
        dr.scatter(self.arrivals_before, arrivals, numbers)
        for g in range(self.n):
            power = types.UInt64(dr.gather(types.UInt32, self.weights, places * self.n + g)) * types.UInt64(counts)
            dr.scatter_add(self.sent, power, numbers * self.n + g, mode=dr.ReduceMode.NoConflicts)
        dr.eval(self.arrivals_before, self.sent)

    def _weigh(self, counters, numbers, places, arrivals) -> None:
        types = counters.types
        wide = types.Float64

        def fraction(rho):
            return wide(dr.gather(types.UInt32, rho, patch)) * 2.0**-32

        patch = counters.tracer.row(numbers)
        quanta = dr.opaque(wide, float(counters.quanta))
        fired = counters.fired_upper.about(dr.gather(types.UInt32, counters.fired, numbers), numbers)
        hits_of = counters.hits.upper.about
        emitted = [dr.gather(wide, share, patch) for share in self.shares]
        first = functools.reduce(dr.maximum, emitted) if self.lines is None else dr.gather(wide, self.lines, patch)
        target_counts = dr.fma(first, quanta, fraction(counters.targets.rho) * hits_of(arrivals, numbers)) - fired
        beyond, panes = None, counters.targets.panes
        if panes is not None:
            beyond = panes.beyond(numbers)
            hits = dr.gather(types.UInt32, counters.hits.arrivals, beyond)
            target_counts += fraction(panes.tau) * hits_of(hits, beyond)
        for g, (share, rho) in enumerate(zip(emitted, self.rhos, strict=True)):
            at = numbers * self.n + g
            received, sent = self._about("received", self.received, at), self._about("sent", self.sent, at)
            power = dr.fma(share, quanta * QUANTUM, fraction(rho) * received) - sent
            if beyond is not None:
                power += fraction(self.taus[g]) * self._about("received", self.received, beyond * self.n + g)
            carried = dr.select(target_counts > 0, dr.clip(power / target_counts, 0, QUANTUM), 0)
            dr.scatter(self.weights, types.UInt32(dr.floor(carried + 0.5)), places * self.n + g)

    def _about(self, name: str, column, at):
        """Return sums at some places in double precision."""
        return self.upper[name].about(dr.gather(self.tracer.types.UInt64, column, at), at)

    def carried(self, types, launch) -> list:
        """Return the power of each group that the line of each lane carries; called in a kernel."""
        place = (launch.rank + launch.batch.start) * self.n
        return [types.UInt64(dr.gather(types.UInt32, self.weights, place + g)) for g in range(self.n)]

    def count_fired(self, counters, batch) -> None:
        """Add the power that left along the lines of a batch, summed from the lines' side; called after the batch."""
        types, replicate = counters.types, counters.tracer.replicate(batch.numbers)
        place, fires = (dr.arange(types.UInt32, dr.width(batch.numbers)) + batch.start) * self.n, batch.counts > 0
        for g in range(self.n):
            power = types.UInt64(dr.gather(types.UInt32, self.weights, place + g, fires)) * types.UInt64(batch.counts)
            at = replicate + g * counters.tracer.replicates
            if batch.total > MUCH:
                dr.scatter_add(self.fired_much, power >> 32, at, active=fires)
                power &= types.UInt64(0xFFFFFFFF)
            dr.scatter_add(self.fired, power, at, active=fires)
        dr.schedule(self.fired, self.fired_much)
