"""Far sides: what falls on one side of a diffusing pane raises the target counts of both sides (contract 17)."""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..problem.quanta import Source
from ..tracing.line_tracer import LineTracer


@dataclass(frozen=True, eq=False)
class FarSides:
    """The rows on the other sides of diffusing panes.

    Attributes:
        tracer: numbers the rows.
        tau: UInt32 (n,), diffuse transmittance times 2^32 of each row.
        other: UInt32 (n,), the row on the other side of each.
        on_host: tau and other on the host.
    """

    tracer: LineTracer
    tau: Any
    other: Any
    on_host: tuple[np.ndarray, np.ndarray]

    @staticmethod
    def of(tracer: LineTracer, source: Source) -> "FarSides | None":
        """Return the far sides of a scalar problem; None where nothing diffuses light."""
        if source.tau is None or source.other is None:
            return None
        u32 = tracer.types.UInt32
        return FarSides(tracer, upload(u32, source.tau), upload(u32, source.other), (source.tau, source.other))

    def crosses(self, patch, active: Any = True):
        """Return whether light crosses patches; called in a kernel."""
        return dr.gather(self.tracer.types.UInt32, self.tau, patch, active) > 0

    def beyond(self, number, active: Any = True):
        """Return the numbers on the other sides; called in a kernel."""
        tracer = self.tracer
        base = tracer.replicate(number) * tracer.n_opaque
        return dr.gather(tracer.types.UInt32, self.other, number - base, active) + base

    def sent_on(self, numbers, arrivals):
        """Return what crosses to rows from the hits of their other sides, in 2^-32 of a line, UInt64; called in a kernel.

        Args:
            numbers: of rows; None for all.
            arrivals: hit counts of all numbers.
        """
        wide = self.tracer.types.UInt64
        tau, hits, _ = self.across(numbers, arrivals)
        return wide(tau) * wide(hits)

    def across(self, numbers, arrivals):
        """Return rows' transmittance, the hits of their other sides, and the numbers of these, UInt32; called in a kernel."""
        u32 = self.tracer.types.UInt32
        number = dr.arange(u32, self.tracer.total) if numbers is None else numbers
        patch = self.tracer.row(number)
        tau, beyond = dr.gather(u32, self.tau, patch), self.beyond(number)
        return tau, dr.gather(u32, arrivals, beyond, tau > 0), beyond

    def with_others(self, numbers: np.ndarray) -> np.ndarray:
        """Return numbers on the host, sorted, with those on the other sides of diffusing panes among them."""
        tau, other = self.on_host
        base, patch = numbers // self.tracer.n * self.tracer.n, numbers % self.tracer.n
        crosses = tau[patch] > 0
        return np.union1d(numbers, base[crosses] + other[patch[crosses]]).astype(np.uint32)

    def spread(self, touched):
        """Return flags of all slots, which a side of a diffusing pane has where either side has it."""
        types = self.tracer.types
        slot = dr.arange(types.UInt32, self.tracer.slots)
        row = slot < self.tracer.total
        number = dr.select(row, slot, 0)
        both = touched | dr.gather(types.Bool, touched, self.beyond(number), row)
        dr.eval(both)
        return both
