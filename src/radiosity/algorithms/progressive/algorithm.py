"""Progressive refinement: the patch with the most unshot power shoots it to all others.

M. F. Cohen, S. E. Chen, J. R. Wallace and D. P. Greenberg, "A progressive refinement approach to fast radiosity image
generation", SIGGRAPH 1988; overshooting after M. Feda and W. Purgathofer, "Accelerating radiosity by overshooting", Third
Eurographics Workshop on Rendering 1992, and docs/baselines.md.
"""

import numpy as np

from ...errors import MethodError
from ...factors.sources import rows_for
from .. import estimate
from ..base import AbstractAlgorithm, Swept
from ..baseline_state import Solved
from ..baseline_tally import SolvedTally
from ..state import Arrays, Sizes
from .recent import RecentRows
from .state import ProgressiveState
from .tally import ProgressiveTally, ambient

UNSHOT = 1e-4  # share of the emitted power that may be left unshot at the end
DENSER = 1.05  # each entry of the history has 1.05 times as many shots as the last


class Progressive(AbstractAlgorithm[ProgressiveState]):
    """Progressive refinement. N is the number of shots; the state after them depends on N alone."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        if self.replicates > 1:
            raise MethodError("progressive refinement follows one sequence of shots and has no replicates; compare seeds instead")
        rows = rows_for(self.geometry, self.problem, self.method, self.seed, 1)
        estimate.progressive(rows, len(self.problem.patches)).check()
        groups, self.area = self.problem.groups, self.problem.patches.area
        self.recent, self.scatter = RecentRows(rows), groups.scatter
        self.wanted, self.shots, self.history = 0, 0, [(0.0, 1.0)]
        self.unshot, self.received = groups.emission.copy(), np.zeros_like(groups.emission)
        self.missed, self.seen = np.zeros((2, groups.n_groups)), np.zeros(len(self.area), np.int64)
        self.emitted, self.cut = self.area @ groups.emission, np.zeros(groups.n_groups)

    @property
    def quanta(self) -> int:
        return self.wanted

    @property
    def stage_independent(self) -> bool:
        return True

    def advance(self, quanta: int, swept: Swept) -> None:
        self.wanted = max(quanta, self.wanted)
        while self.shots < self.wanted and not self._done:
            self._shoot(swept)
        self.wanted = self.shots if self._done else self.wanted

    @property
    def _left(self) -> float:
        """Return the unshot power over the emitted power, of the worst group."""
        return float(self._share(self.area @ np.abs(self.unshot)))

    def _share(self, power: np.ndarray) -> np.ndarray:
        """Return a power over the emitted power, of the worst group."""
        return (power / np.where(self.emitted > 0, self.emitted, 1)).max()

    @property
    def _done(self) -> bool:
        return self._left <= UNSHOT

    def _shoot(self, swept: Swept) -> None:
        extra = np.zeros_like(self.unshot)
        if self.method.overshooting:
            extra = self.scatter.albedo * ambient(self.area, self.scatter.albedo, self.unshot)
        power = self.area[:, None] * (self.unshot + extra)
        urgency = np.abs(power).sum(axis=1)
        i = int(np.argmax(urgency))
        columns, values, escaped, lost = self.recent.get(i, urgency, swept)
        # F_ij A_i / A_j = F_ji cannot exceed one, but estimates from one point can where j is small and near
        possible = np.minimum(values, self.area[columns] / self.area[i])
        arriving = possible[:, None] * power[i]
        self.cut += (values - possible).sum() * np.abs(power[i])
        self.received[columns] += arriving
        self.unshot[columns] += self.scatter.reflectance[columns] * arriving / self.area[columns, None]
        if self.scatter.through is not None and self.scatter.other is not None:
            self.unshot[self.scatter.other[columns]] += self.scatter.through[columns] * arriving / self.area[columns, None]
        self.unshot[i] -= power[i] / self.area[i]
        self.missed += np.array([[escaped], [lost]]) * power[i]
        self.seen[columns] += 1
        self.shots += 1
        if self.shots >= DENSER * self.history[-1][0]:
            self.history.append((self.shots, self._left))

    def capture(self) -> ProgressiveState:
        solved = Solved(
            sizes=self.sizes,
            done=self._done,
            lines=self.recent.lines,
            received=self.received[None].copy(),
            missed=self.missed[None].copy(),
            seen=self.seen.copy(),
            history=np.array(self.history),
        )
        return ProgressiveState(
            sizes=self.sizes,
            quanta=self.wanted,
            shots=self.shots,
            solved=solved,
            unshot=self.unshot.copy(),
            recent=self.recent.numbers,
            cut_power=self.cut.copy(),
            cut=float(self._share(self.cut)),
        )

    def read(self, arrays: Arrays, sizes: Sizes) -> ProgressiveState:
        if ProgressiveState.lacking(arrays, sizes, ("solved",)):
            raise MethodError("the solution to go on from lacks the unshot power of its patches, or has other sizes; start anew")
        return ProgressiveState.read(arrays, sizes)

    def restore(self, state: ProgressiveState) -> None:
        solved = state.solved
        assert solved is not None
        self.wanted, self.shots = state.quanta, state.shots
        self.received, self.missed = solved.received[0].copy(), solved.missed[0].copy()
        self.unshot, self.seen, self.cut = state.unshot.copy(), solved.seen.copy(), state.cut_power.copy()
        self.history = [tuple(row) for row in solved.history]
        if len(state.recent):
            self.recent.make([int(i) for i in state.recent], lambda lines: None)
        self.recent.lines = solved.lines

    @property
    def tally(self) -> ProgressiveTally:
        return ProgressiveTally(self.method.ambient, SolvedTally())
