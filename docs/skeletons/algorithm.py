"""A skeleton to copy: the smallest algorithm that the loop over stages can run. It sends all light on, one reflection a step.

Say here what the algorithm is in one sentence, then its paper: author, title, where, year; equation and page of what you follow.
This one is the series E + rho F E + (rho F)^2 E + ..., with form factors from counted lines; it is here to be read, not used.

To make it yours: copy it to a folder of its own, rename the class, put a line into `ALGORITHMS` (`algorithms/table.py`), and let
`method/combinations.py` or `method/schemes.py` say which choices it serves. `tests/test_skeleton.py` shows what to test first.
"""

import numpy as np

from radiosity.algorithms.base import AbstractAlgorithm, State, Swept
from radiosity.algorithms.baseline_tally import SolvedTally
from radiosity.errors import MethodError
from radiosity.factors.sources import rows_for

LEFT = 1e-6  # of the emitted power: what is less than that is not sent on


class Reflections(AbstractAlgorithm):
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

    def capture(self) -> State:
        """Copies: the run may go on while a checkpoint is written."""
        return {
            "quanta": np.array(self.wanted),
            "steps": np.array(self.steps),
            "done": np.array(self._done),
            "lines": np.array(self.lines),
            "received": self.received.copy(),
            "missed": self.missed.copy(),
            "unsent": self.unsent.copy(),
            "seen": np.full(len(self.area), len(self.area) - 1),
        }

    def restore(self, state: State) -> None:
        if "unsent" not in state or state["unsent"].shape != self.unsent.shape:
            raise MethodError("the solution to go on from lacks the unsent power of its patches, or has other sizes; start anew")
        self.wanted, self.steps, self.lines = (int(state[name]) for name in ("quanta", "steps", "lines"))
        self.received, self.missed, self.unsent = (state[name].copy() for name in ("received", "missed", "unsent"))

    def unfinished(self, state: State) -> bool:
        return int(state["steps"]) < int(state["quanta"]) and not state["done"]

    @property
    def tally(self) -> SolvedTally:
        """Reads irradiance, lines and energy balance from a state. A tally of your own derives from `AbstractTally`."""
        return SolvedTally()
