"""Powers of bands that lines carry where bands differ (contract 3)."""

import functools

import drjit as dr

from ..device.backend import upload
from ..problem.bands import QUANTUM
from ..problem.quanta import Source
from ..problem.source_rows import SourceRows
from ..tracing.line_tracer import LineTracer


class BandTally:
    """Power of each group, in 64-bit fixed point, received by every patch and carried by its lines.

    A line carries, of each band, what its patch has not sent yet divided by the real number of lines owed for it, not by the
    number fired. What is left so in the end is known, and sent on as `residue` tells. The groups of a patch lie side by side
    in memory, so that a landing touches one place.

    Attributes:
        received: UInt64, group g of slot s (see `LineTracer`) at s * n_groups + g.
        sent: UInt64, what lines have carried away from patch numbers, likewise.
        arrivals_before: UInt32, of patch numbers, as they were at the last sweep; None between stages.
        fired: UInt64, power that left replicate r along lines, at g * replicates + r.
        weights: UInt32, of group g, what each line of the i-th patch of a sweep carries, at i * n_groups + g; None between
            stages.
    """

    def __init__(self, tracer: LineTracer, rows: SourceRows, source: Source):
        self.n = rows.emission.shape[1]
        types = tracer.types
        self.shares = [upload(types.Float64, rows.emission[:, g] * rows.area / source.power) for g in range(self.n)]
        self.rhos = [upload(types.UInt32, Source.fixed(rows.reflectance[:, g])) for g in range(self.n)]
        self.received = dr.opaque(types.UInt64, 0, tracer.slots * self.n)
        self.sent = dr.opaque(types.UInt64, 0, tracer.total * self.n)
        self.fired = dr.opaque(types.UInt64, 0, self.n * tracer.replicates)
        self.weights = self.arrivals_before = None

    def rest(self) -> None:
        """Between stages: let go of what only sweeps use."""
        self.weights = self.arrivals_before = None

    def weigh(self, counters, numbers, places, arrivals, counts) -> None:
        """Before a sweep: what each line of the patches ``numbers`` carries, of each group, to ``places`` in ``weights``; in the
        end what ``counts`` of them take away, and ``arrivals`` now. No expression may still wait to read the arrays that are
        written here, or Dr.Jit copies them whole."""
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

        patch = numbers - counters.tracer.replicate(numbers) * counters.tracer.n_opaque
        quanta, fired = dr.opaque(wide, float(counters.quanta)), dr.gather(types.UInt32, counters.fired, numbers)
        emitted = [dr.gather(wide, share, patch) for share in self.shares]
        target_counts = dr.fma(functools.reduce(dr.maximum, emitted), quanta, fraction(counters.rho) * wide(arrivals)) - wide(
            fired
        )
        for g, (share, rho) in enumerate(zip(emitted, self.rhos, strict=True)):
            received, sent = (dr.gather(types.UInt64, column, numbers * self.n + g) for column in (self.received, self.sent))
            power = dr.fma(share, quanta * QUANTUM, fraction(rho) * wide(received)) - wide(sent)
            carried = dr.select(target_counts > 0, dr.clip(power / target_counts, 0, QUANTUM), 0)
            dr.scatter(self.weights, types.UInt32(dr.floor(carried + 0.5)), places * self.n + g)

    def carried(self, types, launch) -> list:
        """In a kernel: the power of each group that a line of each lane carries."""
        place = (launch.rank + launch.batch.start) * self.n
        return [types.UInt64(dr.gather(types.UInt32, self.weights, place + g)) for g in range(self.n)]

    def count_fired(self, counters, batch) -> None:
        """After a batch: the power that left, summed from the lines' side."""
        types, replicate = counters.types, counters.tracer.replicate(batch.numbers)
        place, fires = (dr.arange(types.UInt32, dr.width(batch.numbers)) + batch.start) * self.n, batch.counts > 0
        for g in range(self.n):
            power = types.UInt64(dr.gather(types.UInt32, self.weights, place + g, fires)) * types.UInt64(batch.counts)
            dr.scatter_add(self.fired, power, replicate + g * counters.tracer.replicates, active=fires)
        dr.schedule(self.fired)
