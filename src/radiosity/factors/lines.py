"""Where the lines of a matrix come from: the patches themselves, or the spans of global lines."""

from collections.abc import Callable

import numpy as np

from ..device.backend import upload
from ..method import Method
from ..problem.model import Problem
from ..problem.quanta import phases
from ..sampling.streams import Seed
from ..tally.shooter import Shooter
from ..tracing.geometry import Geometry
from ..tracing.global_lines.spans import ESCAPED, LOST, ONE_WAY, Spans

FEW = 4  # lines of a patch at least
TO_LIGHTS = 0.25  # of all lines, fired in proportion to emitted power; the rest in proportion to area

Add = Callable[[np.ndarray, np.ndarray], None]


class LocalLines:
    """At N lines a replicate, patch i has fired floor(N p_i + phase_i) of them, and 4 at least: N alone tells which.

    Lines in proportion to area alone would say little of small lights, whose form factors matter most. Where each line counts at
    both its ends, a quarter of all lines goes to what emits: that halves the error or better, and more gains little.
    """

    def __init__(
        self, geometry: Geometry, problem: Problem, method: Method, seed: Seed | int, replicates: int, *, both_ways: bool = True
    ):
        self.n, self.total = len(problem.patches), len(problem.patches) * replicates
        self.shooter = Shooter(geometry, method, seed, replicates, 0)
        light = TO_LIGHTS if both_ways else 0.0
        self.share = (1 - light) * problem.patches.area / problem.patches.area.sum() + light * problem.source.share
        self.phase = phases(seed, replicates, self.n) * 2.0**-32

    def targets(self, quanta: int) -> np.ndarray:
        """(replicates, n_patches) uint32, lines that patches have fired at N."""
        if quanta == 0:
            return np.zeros(self.phase.shape, np.uint32)
        return np.maximum(np.floor(self.share * quanta + self.phase), FEW).astype(np.uint32)

    def trace(self, begin: int, end: int, add: Add) -> None:
        """From N to N: ``add`` takes rows, r n + i, and columns; n and n + 1 are escaped and lost."""

        def pairs(numbers: np.ndarray, landed: np.ndarray) -> None:
            missed = (landed - self.total) // len(self.phase) + self.n
            add(numbers, np.where(landed < self.total, landed % self.n, missed))

        more = self.targets(end) - self.targets(begin)
        self.shooter.shoot(upload(self.shooter.types.UInt32, more), pairs=pairs)

    def resume(self, reached: int) -> None:
        """Go on from N."""
        self.shooter.fired = upload(self.shooter.types.UInt32, self.targets(reached))


class GlobalLines:
    """N global lines a replicate; each end of a span on a patch is a line of that patch (Sbert 1993)."""

    def __init__(self, geometry: Geometry, problem: Problem, method: Method, seed: Seed | int, replicates: int):
        self.n, self.replicates = len(problem.patches), replicates
        self.spans = Spans(geometry, method, seed, replicates)

    def trace(self, begin: int, end: int, add: Add) -> None:
        """From N to N, see `LocalLines.trace`."""
        for replicate in range(self.replicates):
            pairs = self.spans.draw(replicate, begin, end - begin)
            one, other = pairs.one.astype(np.int64), pairs.other.astype(np.int64)
            seen = self._column(other)
            forth, back = one < ONE_WAY, other < ONE_WAY  # a patch seen through backs does not see who sees it
            add(one[forth] + replicate * self.n, seen[forth])
            add(other[back] + replicate * self.n, self._column(one)[back])

    def _column(self, code: np.ndarray) -> np.ndarray:
        missed = np.where(code == ESCAPED, self.n, self.n + 1)
        return np.where((code == ESCAPED) | (code == LOST), missed, code & (ONE_WAY - 1))

    def resume(self, reached: int) -> None:
        """Lines are functions of their number: nothing to restore."""
