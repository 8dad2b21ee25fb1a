"""Target counts: how many lines a row must have fired in all, once so many have hit it (contract 2)."""

from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...problem.quanta import WORD, Source
from ...tally.far_sides import FarSides
from ...tally.hit_counts import HitCounts
from ...tracing.line_tracer import LineTracer


class TargetCounts:
    """The rule floor(emitted + rho h + phase) of all rows, in whole numbers.

    Attributes:
        tracer: numbers the rows.
        rho: UInt32 (n,), reflectance times 2^32.
        phase: UInt32 (total,), the rounding offset of each row, times 2^32.
        panes: the far sides of diffusing panes, or None.
        whole, fraction: UInt32 (n,), lines that rows emit in a stage, and 2^32 times what is left over.
        whole_upper: the upper words of ``whole``, or None where all are 0.
        much: True where 32 bits may be too few for what is emitted.
    """

    def __init__(self, tracer: LineTracer, source: Source, phase: np.ndarray):
        self.tracer, self.types, self.source = tracer, tracer.types, source
        self.rho = upload(self.types.UInt32, source.rho)
        self.panes = FarSides.of(tracer, source)
        self.phase = upload(self.types.UInt32, phase)
        self.whole: Any = None
        self.fraction: Any = None
        self.whole_upper: Any = None
        self.much = False

    def begin(self, quanta: int) -> None:
        """Take what rows emit in a stage of N quanta a replicate."""
        u32 = self.types.UInt32
        whole, fraction = self.source.emitted(quanta)
        self.whole, self.fraction = (upload(u32, column.astype(np.uint32, copy=False)) for column in (whole, fraction))
        words = whole.dtype.itemsize > 4
        self.whole_upper = upload(u32, (whole >> WORD).astype(np.uint32)) if words else None
        self.much = words or int(whole.max()) >> 31 > 0

    def after(self, numbers, arrivals, all_hits):
        """Return the target counts of row numbers (None: of all rows) after ``arrivals`` hits, UInt32 modulo 2^32.

        Args:
            all_hits: hit counts of all numbers, from which those of the other sides of diffusing panes are taken.
        """
        u32, wide = self.types.UInt32, self.types.UInt64
        if numbers is None and self.tracer.replicates == 1:
            rho, whole, fraction = self.rho, self.whole, self.fraction
        else:
            number = dr.arange(u32, self.tracer.total) if numbers is None else numbers
            patch = self.tracer.row(number)
            rho, whole, fraction = (dr.gather(u32, column, patch) for column in (self.rho, self.whole, self.fraction))
        low = wide(rho) * wide(arrivals) + wide(fraction) + wide(self.read(self.phase, numbers))
        if self.panes is not None:
            low += self.panes.sent_on(numbers, all_hits)
        return whole + u32(low >> 32)

    def after_wide(self, number, arrivals, hits: HitCounts):
        """Return the target counts of row numbers after ``arrivals`` hits, UInt64; in a kernel.

        A hit count of two words sends on rho times its upper word in whole lines.
        """
        u32, wide = self.types.UInt32, self.types.UInt64
        patch = self.tracer.row(number)
        whole, rho, fraction = (dr.gather(u32, column, patch) for column in (self.whole, self.rho, self.fraction))
        low = wide(rho) * wide(arrivals) + wide(fraction) + wide(self.read(self.phase, number))
        lines = wide(whole) + wide(rho) * wide(hits.upper.upper(arrivals, number))
        if self.whole_upper is not None:
            lines += wide(dr.gather(u32, self.whole_upper, patch)) << 32
        if self.panes is not None:
            tau, others, beyond = self.panes.across(number, hits.arrivals)
            low += wide(tau) * wide(others)
            lines += wide(tau) * wide(hits.upper.upper(others, beyond))
        return lines + (low >> 32)

    def is_raised(self, number, before, active):
        """Return whether one hit after ``before`` others raises the target count of a row by one; called in a kernel.

        On diffusing panes it does not: a hit there may raise the counts of both sides, which the next wavefront finds.
        """
        u32, wide = self.types.UInt32, self.types.UInt64
        patch = self.tracer.row(number)
        rho = wide(dr.gather(u32, self.rho, patch, active))
        rest = wide(dr.gather(u32, self.fraction, patch, active)) + wide(dr.gather(u32, self.phase, number, active))
        low = rho * wide(before) + rest
        raised = ((low + rho) >> 32) > (low >> 32)
        return raised if self.panes is None else raised & ~self.panes.crosses(patch, active)

    def read(self, column, numbers):
        """Return a column's values of row numbers, or of all rows.

        All values are taken without a gather, in a third of the time where they are not in the cache.
        """
        if numbers is not None:
            return dr.gather(self.types.UInt32, column, numbers)
        total = self.tracer.total
        return column if dr.width(column) == total else dr.reshape(self.types.UInt32, column, total, shrink=True)
