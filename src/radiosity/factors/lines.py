"""The lines of a matrix: local lines of the patches, or spans of global lines."""

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
    """Local lines of patches: at N lines a replicate, patch i has fired floor(N p_i + phase_i) lines, and 4 at least.

    With lines in proportion to area alone, the form factors of small lights, which matter most, would have few lines. Where each
    line counts at both its ends, a quarter of all lines goes to what emits. That halves the error or better; more gains little.
    Where sources are preferred, they have their quarter in any case.
    """

    def __init__(
        self, geometry: Geometry, problem: Problem, method: Method, seed: Seed | int, replicates: int, *, both_ways: bool = True
    ):
        self.n, self.total = len(problem.patches), len(problem.patches) * replicates
        self.shooter = Shooter(geometry, method, seed, replicates, 0)
        light = TO_LIGHTS if both_ways or problem.prefers_sources else 0.0
        self.share = (1 - light) * problem.patches.area / problem.patches.area.sum() + light * problem.source.share
        self.phase = phases(seed, replicates, self.n) * 2.0**-32

    def targets(self, quanta: int) -> np.ndarray:
        """Return the lines that patches have fired at N, (replicates, n_patches) uint64."""
        if quanta == 0:
            return np.zeros(self.phase.shape, np.uint64)
        return np.maximum(np.floor(self.share * quanta + self.phase), FEW).astype(np.uint64)

    def trace(self, begin: int, end: int, add: Add) -> None:
        """Trace the lines from N = ``begin`` to ``end``.

        Args:
            add: takes rows, r n + i, and columns; columns n and n + 1 are escaped and lost.
        """

        def pairs(numbers: np.ndarray, slots: np.ndarray) -> None:
            missed = (slots - self.total) // len(self.phase) + self.n
            add(numbers, np.where(slots < self.total, slots % self.n, missed))

        more = self.targets(end) - self.targets(begin)
        self.shooter.shoot(upload(self.shooter.types.UInt32, more.astype(np.uint32)), pairs=pairs)

    def resume(self, reached: int) -> None:
        """Prepare to go on from N = ``reached``."""
        self.shooter.sequences.begin_after(self.targets(reached))


class GlobalLines:
    """Global lines, N a replicate; each end of a span on a patch is a line of that patch (Sbert 1993)."""

    def __init__(self, geometry: Geometry, problem: Problem, method: Method, seed: Seed | int, replicates: int):
        self.n, self.replicates = len(problem.patches), replicates
        self.spans = Spans(geometry, method, seed, replicates)

    def trace(self, begin: int, end: int, add: Add) -> None:
        """Trace the lines from N = ``begin`` to ``end``, see `LocalLines.trace`."""
        for replicate in range(self.replicates):
            pairs = self.spans.draw(replicate, begin, end - begin)
            one, other = pairs.one.astype(np.int64), pairs.other.astype(np.int64)
            seen = self._column(other)
            forth, back = one < ONE_WAY, other < ONE_WAY  # a patch that is seen through a back does not see the other patch
            add(one[forth] + replicate * self.n, seen[forth])
            add(other[back] + replicate * self.n, self._column(one)[back])

    def _column(self, code: np.ndarray) -> np.ndarray:
        missed = np.where(code == ESCAPED, self.n, self.n + 1)
        return np.where((code == ESCAPED) | (code == LOST), missed, code & (ONE_WAY - 1))

    def resume(self, reached: int) -> None:
        """Do nothing: lines are functions of their number."""
