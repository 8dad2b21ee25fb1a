"""Where lines landed: the counts that kernels add to."""

from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import frozen, upload
from ..tracing.line_tracer import LineTracer
from .bands import BandTally


class HitCounts:
    """Counts of every slot (see `LineTracer`), and with them what lines brought.

    Attributes:
        tracer: whose slots these are.
        arrivals: UInt32 (slots,), lines that landed.
        bands: powers of bands that lines carry, or None.
        touched: Bool (slots,), a line landed there since `forget_touched`, where that is asked for.
    """

    def __init__(self, tracer: LineTracer, bands: BandTally | None = None):
        self.tracer, self.bands = tracer, bands
        self.arrivals: Any = dr.opaque(tracer.types.UInt32, 0, tracer.slots)
        self.touched: Any = None

    def forget_touched(self) -> None:
        """No line has landed anywhere since now."""
        self.touched = dr.opaque(self.tracer.types.Bool, False, self.tracer.slots)

    def add(self, slot, active: Any = True, mode: dr.ReduceMode = dr.ReduceMode.Auto) -> None:
        """In a kernel: a line landed in each slot."""
        dr.scatter_add(self.arrivals, self.tracer.types.UInt32(1), slot, active=active, mode=mode)

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """On the host: arrivals (replicates, n) uint32, and escaped and lost lines, (2, replicates)."""
        flat, tracer = frozen(self.arrivals), self.tracer
        return flat[: tracer.total].reshape(tracer.replicates, tracer.n), flat[tracer.total :].reshape(2, tracer.replicates)

    def write(self, arrivals: np.ndarray, missed: np.ndarray) -> None:
        """Put back what `read` gave."""
        self.arrivals = upload(self.tracer.types.UInt32, np.concatenate([arrivals.ravel(), missed.ravel()]))
