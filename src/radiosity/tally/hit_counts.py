"""Hit counts, which kernels add to."""

from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import frozen, upload
from ..tracing.line_tracer import LineTracer
from .bands import BandTally


class HitCounts:
    """Hit counts of every slot (see `LineTracer`), and the power of bands that lines brought.

    Attributes:
        tracer: the line tracer that numbers the slots.
        arrivals: UInt32 (slots,), the hit count of each slot.
        bands: powers of bands that lines carry, or None.
        touched: Bool (slots,), whether a line hit the slot since `forget_touched`; written only where flags are asked for.
    """

    def __init__(self, tracer: LineTracer, bands: BandTally | None = None):
        self.tracer, self.bands = tracer, bands
        self.arrivals: Any = dr.opaque(tracer.types.UInt32, 0, tracer.slots)
        self.touched: Any = None

    def forget_touched(self) -> None:
        """Set all flags of ``touched`` back to false."""
        self.touched = dr.opaque(self.tracer.types.Bool, False, self.tracer.slots)

    def add(self, slot, active: Any = True, mode: dr.ReduceMode = dr.ReduceMode.Auto) -> None:
        """Count one hit in each slot; called in a kernel."""
        dr.scatter_add(self.arrivals, self.tracer.types.UInt32(1), slot, active=active, mode=mode)

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """Copy the counts to the host: arrivals, (replicates, n) uint32, and escaped and lost lines, (2, replicates)."""
        flat, tracer = frozen(self.arrivals), self.tracer
        return flat[: tracer.total].reshape(tracer.replicates, tracer.n), flat[tracer.total :].reshape(2, tracer.replicates)

    def write(self, arrivals: np.ndarray, missed: np.ndarray) -> None:
        """Set the counts to what `read` returned."""
        self.arrivals = upload(self.tracer.types.UInt32, np.concatenate([arrivals.ravel(), missed.ravel()]))
