"""Source sampling: how many walks begin on each patch at N quanta."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...device.backend import upload
from ...problem.model import Problem
from ...problem.quanta import Source, phases, target_counts
from ...sampling.blocks import BLOCK, parts
from ...sampling.streams import Seed
from ...tracing.lanes import Batch
from ...tracing.line_tracer import LineTracer


@dataclass(frozen=True)
class Begun:
    """Walks that begin together: their block (`sampling.blocks`), a batch, and the largest index within the block."""

    block: int
    batch: Batch
    largest: int


@dataclass(frozen=True, eq=False)
class SourceSampling:
    """The number of walks of patch i at N quanta: floor(N share_i + phase_i), as patches of the firing engine emit (contract 2).

    So the walks of any N are among those of a larger one.

    Attributes:
        source: shares of emitted power for shooting, of area for gathering.
        phase: (replicates, n_patches) uint32.
    """

    source: Source
    phase: np.ndarray

    @staticmethod
    def of_power(problem: Problem, seed: Seed | int, replicates: int) -> "SourceSampling":
        """Return the sampling of particles that leave lights in proportion to their power."""
        return SourceSampling(problem.source, phases(seed, replicates, len(problem.patches)))

    @staticmethod
    def of_area(problem: Problem, seed: Seed | int, replicates: int) -> "SourceSampling":
        """Return the sampling of gathering walks, which leave all patches in proportion to their area."""
        area = problem.patches.area
        source = Source(area / area.sum(), problem.source.rho, problem.source.power)
        return SourceSampling(source, phases(seed, replicates, len(area)))

    def count(self, quanta: int) -> np.ndarray:
        """Return the number of walks at N quanta, (replicates, n_patches): uint32 where that suffices, else uint64."""
        if quanta == 0:
            return np.zeros(self.phase.shape, np.uint32)
        found = target_counts(self.source, quanta, np.zeros(self.phase.shape[1], np.uint32), self.phase)
        return found if int(found.max()) >= BLOCK else found.astype(np.uint32)

    def batches(self, tracer: LineTracer, before: int, quanta: int) -> Iterator[Begun]:
        """Yield the walks that are new at N = quanta after N = before, block by block."""
        old, now = self.count(before).ravel(), self.count(quanta).ravel()
        for block, begin, more in [(0, old, now - old)] if now.dtype == np.uint32 else parts(old, now - old):
            rows = np.flatnonzero(more)
            if not len(rows):
                continue
            columns = (rows.astype(np.uint32), more[rows].astype(np.uint32), begin[rows].astype(np.uint32))
            numbers, counts, fired = (upload(tracer.types.UInt32, column) for column in columns)
            largest = BLOCK - 1 if block else int((begin + more).max())
            yield Begun(block, Batch.of(tracer.types, numbers, counts, fired, tracer.record), largest)
