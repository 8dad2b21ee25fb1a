"""A skeleton to copy: the smallest algorithm that the loop over stages can run. It sends all light on, one reflection a step.

Say here what the algorithm is in one sentence, then its paper: author, title, where, year; equation and page of what you follow.
This one is the series E + rho F E + (rho F)^2 E + ..., with form factors from counted lines; it is here to be read, not used.

To make it yours: copy it to a folder of its own, rename the class, put a line into `ALGORITHMS` (`algorithms/table.py`), and let
`method/combinations.py` or `method/schemes.py` say which choices it serves. `tests/test_skeleton.py` shows what to test first.
"""

from dataclasses import dataclass

import numpy as np

from radiosity.algorithms.base import AbstractAlgorithm, Swept
from radiosity.algorithms.baseline_state import AbstractSolvedState, Solved
from radiosity.algorithms.baseline_tally import SolvedTally
from radiosity.algorithms.state import Arrays, Sizes, array, number
from radiosity.errors import MethodError
from radiosity.factors.sources import rows_for

LEFT = 1e-6  # of the emitted power: what is less than that is not sent on


@dataclass(frozen=True, eq=False, kw_only=True)
class ReflectionsState(AbstractSolvedState):
    """What a run needs to go on, with what it has found. Names of fields are those of arrays in files.

    Each field says how its array lies, so that files are checked and runs of other replicates can be merged (`array`).

    Attributes:
        steps: reflections so far.
        unsent: (replicates, n_patches, groups) float64, W or lm.
    """

    steps: int = number(int)
    unsent: np.ndarray = array("replicates", "rows", "groups")

    @property
    def unfinished(self) -> bool:
        return self.solved is None or (self.steps < self.quanta and not self.solved.done)


class Reflections(AbstractAlgorithm[ReflectionsState]):
    """N reflections. The state after N depends on N alone: every stage goes on where the last one ended."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        groups, shape = self.problem.groups, (self.replicates, len(self.problem.patches), self.problem.groups.n_groups)
        self.area = self.problem.patches.area
        self.rows = rows_for(self.geometry, self.problem, self.method, self.seed, self.replicates)
        self.wanted, self.steps, self.lines = 0, 0, 0
        self.unsent = np.broadcast_to(groups.emission * self.area[:, None], shape).copy()  # W, of each replicate and group
        self.received, self.missed = np.zeros(shape), np.zeros((self.replicates, 2, groups.n_groups))

    @property
    def quanta(self) -> int:
        return self.wanted

    @property
    def stage_independent(self) -> bool:
        return True

    def advance(self, quanta: int, swept: Swept) -> None:
        """Every step is whole before ``swept`` is called: what it raises ends the stage, and loses nothing."""
        self.wanted = max(quanta, self.wanted)
        while self.steps < self.wanted and not self._done:
            before = self.lines
            self._step()
            swept(self.lines - before)

    @property
    def _done(self) -> bool:
        emitted = self.area @ self.problem.groups.emission
        return bool((self.unsent.sum(axis=1) <= LEFT * emitted).all())

    def _step(self) -> None:
        """Send the power of all patches along the rows of F, and reflect what arrives."""
        everything = np.arange(len(self.area))
        for replicate, power in enumerate(self.unsent):
            rows = self.rows.make(everything, replicate, lambda lines: None)
            arriving = np.zeros_like(power)
            np.add.at(arriving, rows.columns, rows.values[:, None] * power[np.repeat(rows.numbers, np.diff(rows.begin))])
            self.missed[replicate] += np.stack([rows.escaped, rows.lost]) @ power
            self.received[replicate] += arriving
            self.unsent[replicate] = self.problem.groups.reflectance * arriving
            self.lines += rows.lines
        self.steps += 1

    def capture(self) -> ReflectionsState:
        """Copies: the run may go on while a checkpoint is written."""
        solved = Solved(
            sizes=self.sizes,
            done=self._done,
            lines=self.lines,
            received=self.received.copy(),
            missed=self.missed.copy(),
            seen=np.full(len(self.area), self.replicates * (len(self.area) - 1)),
            history=np.zeros((0, 2)),
        )
        return ReflectionsState(sizes=self.sizes, quanta=self.wanted, solved=solved, steps=self.steps, unsent=self.unsent.copy())

    def read(self, arrays: Arrays, sizes: Sizes) -> ReflectionsState:
        """Arrays of a file become a state, or are refused."""
        if lacking := ReflectionsState.lacking(arrays, sizes, ("solved",)):
            raise MethodError(f"the solution to go on from lacks the power of its patches ({lacking}); start anew")
        return ReflectionsState.read(arrays, sizes)

    def restore(self, state: ReflectionsState) -> None:
        solved = state.solved
        assert solved is not None
        self.wanted, self.steps, self.lines = state.quanta, state.steps, solved.lines
        self.received, self.missed, self.unsent = solved.received.copy(), solved.missed.copy(), state.unsent.copy()

    @property
    def tally(self) -> SolvedTally:
        """Reads irradiance, lines and energy balance from a state. A tally of your own derives from `AbstractTally`."""
        return SolvedTally()
