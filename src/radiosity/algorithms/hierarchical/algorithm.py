"""Hierarchical radiosity as an algorithm: a round of refinement is a quantum."""

import numpy as np

from ...errors import MethodError
from ...factors.missed import missed
from ...patches import Hierarchy
from ...sampling.streams import Seed
from ..base import AbstractAlgorithm, Swept
from ..baseline_state import Solved
from ..baseline_tally import SolvedTally
from ..state import Arrays, Sizes
from . import roots
from .indicated import indicated
from .links import Links
from .parameters import Hierarchical as Parameters
from .rounds import Pass, Rounds
from .state import HierarchicalState, Kept

MISSED = 1 << 24  # lines of all patches that find what escapes, at most 1024 and at least 16 a patch


class Hierarchical(AbstractAlgorithm[HierarchicalState]):
    """Hierarchical radiosity. N is the number of rounds, at most all of them.

    Each round begins where the last one ended, so the result depends on N alone.
    """

    def __init__(self, *arguments):
        super().__init__(*arguments)
        if self.replicates > 1:
            raise MethodError(
                "hierarchical radiosity follows one sequence of refinements and has no replicates; compare seeds instead"
            )
        method, self.wanted, self.lines, self._swept = self.method, 0, 0, None
        parameters = Parameters(method.epsilon, method.refinement, method.lines_of_pair, seed=Seed.of(self.seed).value)
        self.errors: np.ndarray | None = None
        tree = Hierarchy(self.problem.patches)
        if not parameters.clustered(len(tree.side_face)):
            roots.check(tree)
        self.rounds = Rounds(self.problem.patches, self.geometry, parameters, self._told)
        lines = min(1024, max(MISSED // len(self.problem.patches), 16))
        self.missed = np.stack(missed(self.geometry, lines, Seed.of(self.seed).value))

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

    def capture(self) -> HierarchicalState:
        """Return the state. The power of each group of bands is that of its leading band."""
        groups, patches, rounds = self.problem.groups, self.problem.patches, self.rounds
        leader = [int(np.flatnonzero((groups.index == g) & (groups.scale == 1))[0]) for g in range(groups.n_groups)]
        power = patches.area[:, None] * (patches.emission + patches.reflectance * rounds.irradiance)
        received = (patches.area[:, None] * rounds.irradiance)[:, leader]
        solved = Solved(
            sizes=self.sizes,
            done=rounds.done,
            lines=self.lines,
            received=received[None],
            missed=(self.missed @ power)[None][..., leader],
            seen=self._seen(),
            history=np.array([(i + 1, p.change) for i, p in enumerate(rounds.history)]).reshape(-1, 2),
        )
        numbers = {"quanta": self.wanted, "rounds": rounds.complete, "links": len(rounds.links)}
        kept = Kept(sizes=self.sizes, irradiance=rounds.irradiance, **vars(rounds.links))
        return HierarchicalState(sizes=self.sizes, solved=solved, kept=kept, indicated=self._indicated(), **numbers)

    def _indicated(self) -> np.ndarray | None:
        """Return the indicated errors once all rounds are complete; they are found once."""
        if self.rounds.done and self.errors is None:
            told, self.rounds.told = self.rounds.told, lambda lines: None  # the state is captured: nothing may end it
            self.errors = indicated(self.rounds)
            self.rounds.told = told
        return self.errors

    def _seen(self) -> np.ndarray:
        """The number of links that bring light to each patch, (n_patches,)."""
        links, levels = self.rounds.links, self.rounds.levels
        count = np.bincount(links.receiver[links.factor > 0], minlength=len(levels.area)).astype(float)
        return levels.push(count[:, None])[:, 0].astype(np.int64)

    def read(self, arrays: Arrays, sizes: Sizes) -> HierarchicalState:
        if lacking := HierarchicalState.lacking(arrays, sizes, ("solved",)):
            raise MethodError(f"the solution lacks results of hierarchical radiosity ({lacking}); solve it anew")
        return HierarchicalState.read(arrays, sizes)

    def restore(self, state: HierarchicalState) -> None:
        if state.kept is None or state.solved is None:
            raise MethodError(
                "the solution is of an older version, which kept no links: there is nothing to go on from; start anew"
            )
        kept, links = state.kept, self._links(state.kept)
        self.wanted, self.lines = state.rounds, state.solved.lines
        history = [Pass(np.nan, state.links, change) for _, change in state.solved.history]
        self.rounds.restore(links, np.array(kept.irradiance), history, state.rounds)

    def _links(self, kept: Kept) -> Links:
        """Return links of a file.

        Raises:
            MethodError: they are of no elements of this scene.
        """
        links = Links(*(np.array(getattr(kept, name)) for name in ("receiver", "source", "factor", "spread")))
        ends, count = np.concatenate([links.receiver, links.source]), len(self.rounds.levels.area)
        lengths = {len(value) for value in vars(links).values()}
        if len(lengths) != 1 or (len(ends) and not 0 <= ends.min() <= ends.max() < count):
            raise MethodError(f"the solution's links are not between the {count} elements of this scene; start anew")
        return links

    @property
    def tally(self) -> SolvedTally:
        return SolvedTally()
