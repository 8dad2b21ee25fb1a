"""Hierarchical radiosity as a process: a round of refinement is a quantum."""

import numpy as np

from ...errors import MethodError
from ...factors.missed import missed
from ...patches import Hierarchy
from ..base import AbstractAlgorithm, State, Swept
from ..baseline_tally import SolvedTally
from . import roots
from .parameters import Hierarchical as Parameters
from .rounds import Rounds


class Hierarchical(AbstractAlgorithm):
    """N rounds, or as many as there are; each begins where the last one ended, so N alone tells the result."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        if self.replicates > 1:
            raise MethodError(
                "hierarchical radiosity follows one sequence of refinements and has no replicates; compare seeds instead"
            )
        roots.check(Hierarchy(self.problem.patches))
        method, self.wanted, self.lines, self._swept = self.method, 0, 0, None
        parameters = Parameters(method.epsilon, method.refinement, method.lines_of_pair, seed=self.seed)
        self.rounds = Rounds(self.problem.patches, self.geometry, parameters, self._told)
        self.missed = np.stack(missed(self.geometry, seed=self.seed))

    def _told(self, lines: int) -> None:
        self.lines += lines
        if self._swept is not None:
            self._swept(lines)

    @property
    def quanta(self) -> int:
        return self.wanted

    @property
    def stage_independent(self) -> bool:
        return True

    def advance(self, quanta: int, swept: Swept) -> None:
        self.wanted, self._swept = max(quanta, self.wanted), swept
        while self.rounds.complete < self.wanted and not self.rounds.done:
            self.rounds.advance()
        self.wanted = self.rounds.complete

    def capture(self) -> State:
        """Powers of groups of bands: each is that of its leading band."""
        groups, patches, rounds = self.problem.groups, self.problem.patches, self.rounds
        leader = [int(np.flatnonzero((groups.index == g) & (groups.scale == 1))[0]) for g in range(groups.n_groups)]
        power = patches.area[:, None] * (patches.emission + patches.reflectance * rounds.irradiance)
        received = (patches.area[:, None] * rounds.irradiance)[:, leader]
        return {
            "quanta": np.array(self.wanted),
            "rounds": np.array(rounds.complete),
            "done": np.array(rounds.done),
            "lines": np.array(self.lines),
            "received": received[None],
            "missed": (self.missed @ power)[None][..., leader],
            "seen": self._seen(),
            "history": np.array([(i + 1, p.change) for i, p in enumerate(rounds.history)]).reshape(-1, 2),
            "links": np.array(len(rounds.links)),
        }

    def _seen(self) -> np.ndarray:
        """(n_patches,) how many links bring light to each."""
        links, levels = self.rounds.links, self.rounds.levels
        count = np.bincount(links.receiver[links.factor > 0], minlength=len(levels.area)).astype(float)
        return levels.push(count[:, None])[:, 0].astype(np.int64)

    def restore(self, state: State) -> None:
        raise MethodError("hierarchical radiosity keeps no links in its results: there is nothing to go on from; start anew")

    def unfinished(self, state: State) -> bool:
        return int(state["rounds"]) < int(state["quanta"])

    @property
    def tally(self) -> SolvedTally:
        return SolvedTally()
