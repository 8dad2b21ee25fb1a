"""Hit counts, which kernels add to."""

from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import frozen, upload
from ..tracing.line_tracer import LineTracer
from .bands import BandTally
from .wraps import Wraps


class HitCounts:
    """Hit counts of every slot (see `LineTracer`), and the power of bands that lines brought.

    Attributes:
        tracer: the line tracer that numbers the slots.
        arrivals: UInt32 (slots,), the hit count of each slot, modulo 2^32.
        upper: upper words of the rows' hit counts; `missed_upper` has those of lines that escaped and were lost.
        bands: powers of bands that lines carry, or None.
        touched: Bool (slots,), whether a line hit the slot since `forget_touched`; written only where flags are asked for.
    """

    def __init__(self, tracer: LineTracer, bands: BandTally | None = None):
        self.tracer, self.bands = tracer, bands
        self.arrivals: Any = dr.opaque(tracer.types.UInt32, 0, tracer.slots)
        self.touched: Any = None
        self.upper, self.missed_upper = Wraps(tracer.types), Wraps(tracer.types)

    @property
    def rows(self):
        """The part of ``arrivals`` that counts hits of rows; not copied."""
        return dr.reshape(self.tracer.types.UInt32, self.arrivals, self.tracer.total, shrink=True)

    @property
    def missed(self):
        """The part of ``arrivals`` that counts lines that escaped and were lost."""
        types, tracer = self.tracer.types, self.tracer
        at = dr.arange(types.UInt32, 2 * tracer.replicates) + dr.opaque(types.UInt32, tracer.total)
        return dr.gather(types.UInt32, self.arrivals, at)

    def look(self) -> None:
        """Note which counts wrapped around; called every `PERIOD` lines or more often."""
        self.upper.look(self.rows)
        self.missed_upper.look(self.missed)

    def forget_touched(self) -> None:
        """Set all flags of ``touched`` back to false."""
        self.touched = dr.opaque(self.tracer.types.Bool, False, self.tracer.slots)

    def add(self, slot, active: Any = True, mode: dr.ReduceMode = dr.ReduceMode.Auto) -> None:
        """Count one hit in each slot; called in a kernel."""
        dr.scatter_add(self.arrivals, self.tracer.types.UInt32(1), slot, active=active, mode=mode)

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """Copy the counts to the host: arrivals, (replicates, n), and escaped and lost lines, (2, replicates).

        They are uint32 where that suffices, else uint64.
        """
        flat, tracer = frozen(self.arrivals), self.tracer
        rows = flat[: tracer.total] if self.upper.halves is None else self.upper.values(self.rows)
        missed = flat[tracer.total :] if self.missed_upper.halves is None else self.missed_upper.values(self.missed)
        return rows.reshape(tracer.replicates, tracer.n), missed.reshape(2, tracer.replicates)

    def write(self, arrivals: np.ndarray, missed: np.ndarray) -> None:
        """Set the counts to what `read` returned."""
        self.arrivals = upload(self.tracer.types.UInt32, np.concatenate([self.upper.of(arrivals), self.missed_upper.of(missed)]))
