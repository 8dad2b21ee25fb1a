"""The matrix method: form factors from counted lines, then the equation (Sbert 1993 with global lines; also with local lines).

M. Sbert, "An integral geometry based method for fast form-factor computation", Computer Graphics Forum 12(3), 1993.
"""

import numpy as np

from ...errors import MethodError
from ...factors.counts import PairCounts
from ...factors.lines import GlobalLines, LocalLines
from ..base import AbstractAlgorithm, Interrupted, Swept
from ..state import Arrays, Sizes
from .state import MatrixState
from .tally import MatrixTally

LIMIT = 1 << 28  # most pairs that are kept: 3 GiB, and as much again while they are merged
LAUNCH = 1 << 22  # lines between two looks at the clock


class Matrix(AbstractAlgorithm[MatrixState]):
    """Counts lines between patches. N lines a replicate give the same counts in any stages."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        # a line between patches counts for both, unless they may see each other through backs that hide one of them
        both_ways = self.method.lines == "local" and not self.geometry.some_backs_pass
        arguments = (self.geometry, self.problem, self.method, self.seed, self.replicates)
        if self.method.lines == "local":
            self.lines: LocalLines | GlobalLines = LocalLines(*arguments, both_ways=both_ways)
        else:
            self.lines = GlobalLines(*arguments)
        self.n, self.counts, self.wanted, self.reached = len(self.problem.patches), PairCounts(), 0, 0
        self.reader = MatrixTally(both_ways, directed=self.geometry.some_backs_pass)

    @property
    def quanta(self) -> int:
        return self.wanted

    @property
    def stage_independent(self) -> bool:
        return True

    def advance(self, quanta: int, swept: Swept) -> None:
        self.wanted = max(quanta, self.wanted)
        traced = 0

        def add(rows: np.ndarray, columns: np.ndarray) -> None:
            nonlocal traced
            self.counts.add(rows, columns)
            traced += len(rows)

        while self.reached < self.wanted:
            end = min(self.wanted, self.reached + max(1, LAUNCH // self.replicates))
            self._check(end)
            traced = 0
            self.lines.trace(self.reached, end, add)
            self.reached = end
            swept(traced)

    def _check(self, end: int) -> None:
        """Refuse pairs that would not fit into memory; there are at most as many as lines, and as patches squared."""
        ends = len(self.counts) / max(self.reached, 1) if self.reached else 1.0 * self.replicates
        expected = min(self.replicates * self.n * (self.n + 2), len(self.counts) + int(ends * (end - self.reached)))
        if expected <= LIMIT:
            return
        reason = (
            f"the form factors of {self.n} patches in {self.replicates} replicates may come to {expected:.2g} pairs after {end} "
            f"lines each, and {LIMIT:.2g} are kept at most; take fewer replicates, fewer patches, or an order without factors"
        )
        raise Interrupted(reason) if self.reached else MethodError(reason)

    def capture(self) -> MatrixState:
        keys, counts = self.counts.arrays
        numbers = {"quanta": self.wanted, "reached": self.reached, "replicates": self.replicates}
        return MatrixState(sizes=self.sizes, keys=keys, counts=counts, **numbers)

    def read(self, arrays: Arrays, sizes: Sizes) -> MatrixState:
        lacking = MatrixState.lacking(arrays, sizes)
        if lacking or int(arrays["replicates"]) != sizes.replicates or len(arrays["keys"]) != len(arrays["counts"]):
            raise MethodError("the solution to go on from lacks the counts of its lines, or has other replicates; start anew")
        return MatrixState.read(arrays, sizes)

    def restore(self, state: MatrixState) -> None:
        self.counts = PairCounts(state.keys, state.counts)
        self.wanted, self.reached = state.quanta, state.reached
        self.lines.resume(self.reached)

    @property
    def tally(self) -> MatrixTally:
        return self.reader
