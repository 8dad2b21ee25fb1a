"""Counters of the lines that patches have fired, apart for each sequence of points.

Each sequence counts its own lines and has its own points, independent of the others. Lights without area follow the patches.
"""

from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..sampling.blocks import BLOCK
from ..sampling.streams import Purpose
from ..tracing.line_tracer import LineTracer
from .wraps import Wraps


class Sequences:
    """Lines of each patch number in each sequence; one of them is taken for the next lines.

    Attributes:
        taken: the number of the one that is taken.
        tracer: lines of the patches, with the points of the one that is taken.
        fired: UInt32 (total,), lines of each patch number in the one that is taken, modulo 2^32.
    """

    def __init__(self, tracer: LineTracer, number: int):
        self.types, self.taken, self.tracer = tracer.types, 0, tracer
        self._tracers = [tracer, *(tracer.of_stream(Purpose.SEQUENCE, more) for more in range(1, number))]
        self._fired: list[Any] = [dr.opaque(self.types.UInt32, 0, tracer.total) for _ in range(number)]
        self._upper = [Wraps(self.types) for _ in range(number)]

    def __len__(self) -> int:
        return len(self._fired)

    @property
    def fired(self) -> Any:
        return self._fired[self.taken]

    @fired.setter
    def fired(self, counts: Any) -> None:
        self._fired[self.taken] = counts

    @property
    def upper(self) -> Wraps:
        """Upper words of ``fired``."""
        return self._upper[self.taken]

    def take(self, sequence: int) -> None:
        """Use this sequence for the next lines."""
        self.taken, self.tracer = sequence, self._tracers[sequence]

    def look(self) -> None:
        """Note which counters wrapped around; called every `PERIOD` lines or more often."""
        for upper, fired in zip(self._upper, self._fired, strict=True):
            upper.look(fired)

    def read(self) -> tuple[np.ndarray, np.ndarray | None]:
        """Copy the counters to the host: their sums over sequences, and where there are several, each of them, else None.

        They are (replicates, n_patches) and (sequences, replicates, n_patches), uint32 where that suffices, else uint64.
        """
        shape = self.tracer.replicates, self.tracer.n
        columns = [upper.values(low).reshape(shape) for upper, low in zip(self._upper, self._fired, strict=True)]
        if len(columns) == 1:
            return columns[0], None
        apart = np.stack(columns)
        fired = apart.sum(axis=0, dtype=np.uint64)
        return fired if int(fired.max()) >= BLOCK else fired.astype(np.uint32), apart

    def write(self, fired: np.ndarray, apart: np.ndarray | None) -> None:
        """Set the counters to what `read` returned."""
        columns = fired[None] if apart is None else apart
        self._fired = [upload(self.types.UInt32, upper.of(x)) for upper, x in zip(self._upper, columns, strict=True)]

    def begin_after(self, fired: np.ndarray) -> None:
        """Let the next lines follow the first ``fired`` ones of each patch, (replicates, n_patches)."""
        self.fired = upload(self.types.UInt32, self.upper.of(fired))
