"""Fractional absorption: of M walks the first M rho^k go on at the k-th hit (A. Keller, "Quasi-Monte Carlo radiosity", 7th
Eurographics Workshop on Rendering, 1996; the rule as in his "Instant radiosity", 1997).

The first patch of walk n is chosen by the fifth number of point n, so that the first walks are a fair sample of all. A hit on
patch i multiplies the power by rho_i c_k / c_(k+1), where c_k walks go on k times: only the last segment is cut off, a bias of
the order of 1 / M.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...problem.model import Problem
from ...sampling.blocks import BLOCK, parts
from ...tracing.lanes import Batch
from ...tracing.line_tracer import LineTracer
from .source_sampling import Begun

MIX = 0x9E3779B1  # low bits of the choice, of which a number in single precision has only 24


@dataclass
class Fractions:
    """The patches where walks begin, and the fixed shares that go on.

    Attributes:
        tracer: lines of the patches.
        cumulative: UInt32 (n_patches,), the sum of shares of emission up to each patch, times 2^32.
        mean: area-weighted mean reflectance, of the largest band.
        begun: walks of earlier stages.
        counts: walks of this stage that go on k times.
    """

    tracer: LineTracer
    cumulative: Any
    mean: float
    begun: int = 0
    counts: list[int] = field(default_factory=list)

    @staticmethod
    def of(tracer: LineTracer, problem: Problem) -> "Fractions":
        """Return the fractions of a problem."""
        area, rho = problem.patches.area, problem.groups.reflectance.max(axis=1)
        whole = np.cumsum(problem.source.share)
        cumulative = np.minimum(np.floor(whole / whole[-1] * 2.0**32), 2**32 - 1).astype(np.uint32)
        lit = np.flatnonzero(problem.source.share)[-1]
        cumulative[lit:] = 2**32 - 1
        return Fractions(tracer, upload(tracer.types.UInt32, cumulative), float(area @ rho / area.sum()))

    def batches(self, before: int, quanta: int) -> Iterator[Begun]:
        """Yield walks before + 1 to quanta of each replicate, block by block; the kernel chooses their patches.

        Of the walks of a block the same shares go on as of those of a stage.
        """
        tracer, u32 = self.tracer, self.tracer.types.UInt32
        for block, begun, more in parts(np.array([before]), np.array([quanta - before])):
            self.begun, new = int(begun[0]), int(more[0])
            self.counts = [new]
            while self.counts[-1]:
                self.counts.append(int(new * self.mean ** len(self.counts)))
            numbers = upload(u32, np.arange(tracer.replicates, dtype=np.uint32) * tracer.n)
            counts, fired = (dr.opaque(u32, value, tracer.replicates) for value in (new, self.begun))
            largest = BLOCK - 1 if block else quanta
            yield Begun(block, Batch.of(tracer.types, numbers, counts, fired, tracer.record), min(largest, BLOCK - 1))

    def birthplace(self, number, index, bits: int):
        """Return the patch number where a walk begins, and its record; called in a kernel. ``number`` gives the replicate."""
        tracer, types = self.tracer, self.tracer.types
        replicate = tracer.replicate(number)
        chosen = tracer.points(number, index, replicate, tracer.record(number), bits)[4]
        position = (types.UInt32(chosen * 2.0**24) << 8) | ((index * MIX) >> 24)
        patch = dr.binary_search(
            0,
            tracer.n - 1,
            lambda at: dr.gather(types.UInt32, self.cumulative, at) <= position,
        )
        here = replicate * tracer.n_opaque + patch
        return here, tracer.record(here)

    def go_on(self, index, segment: int):
        """Return the mask of walks that go on at hit number ``segment``."""
        return index - dr.opaque(self.tracer.types.UInt32, self.begun) <= dr.opaque(
            self.tracer.types.UInt32, self._count(segment)
        )

    def factor(self, segment: int):
        """Return how many walks each of those stands for, Float."""
        after = self._count(segment)
        return dr.opaque(self.tracer.types.Float, self._count(segment - 1) / after if after else 0.0)

    def _count(self, segment: int) -> int:
        return self.counts[segment] if segment < len(self.counts) else 0
