"""Runs whose replicates advance in parts, on several machines or one after the other (contracts 15 and 16).

A stage begins with the state of all replicates, which is split; each part goes to its end, and the states are merged. So between
stages the state is that of one run. Within a stage the state is that of all parts, and a run can go on from it in either way.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from ..errors import MethodError
from ..problem.model import Problem
from ..sampling.streams import Seed
from .base import AbstractAlgorithm, AbstractTally, Swept
from .merging import merge
from .splitting import divisible, split
from .state import AbstractState, Arrays, Sizes

TABLE, PREFIX = "parts", "part{}_"  # names of arrays: the table of parts, and what begins the names of those of a part


@dataclass(frozen=True, eq=False)
class Share:
    """A part of a run's replicates within a stage.

    Attributes:
        first, count: its replicates, counted from 0 on within the run.
        state: the state so far; None before its first line.
        done: True where its stage is complete.
    """

    first: int
    count: int
    state: AbstractState | None = None
    done: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class PartsState(AbstractState):
    """The state of a run within a stage: those of its parts, in the order of their replicates."""

    shares: tuple[Share, ...] = ()

    @property
    def unfinished(self) -> bool:
        return True

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays of all parts by name, and a table: first replicate, count, has a state, is done."""
        table = [(share.first, share.count, share.state is not None, share.done) for share in self.shares]
        found = {"quanta": np.asarray(self.quanta), TABLE: np.array(table, np.int64)}
        for at, share in enumerate(self.shares):
            if share.state is not None:
                found |= {PREFIX.format(at) + name: value for name, value in share.state.arrays().items()}
        return found


class AbstractCrew(ABC):
    """What brings the parts of a run forward."""

    @abstractmethod
    def cut(self, replicates: int) -> list[int]:
        """Return the numbers of replicates of the parts of a stage."""

    @abstractmethod
    def complete(self, run: "InParts", shares: list[Share], quanta: int, swept: Swept) -> None:
        """Bring all shares to the end of the stage of N quanta.

        Each share is replaced in the list as it goes on. Where ``swept`` ends the work by an exception, the list holds whole
        states.
        """

    def behind(self) -> float:
        """Return for how many seconds work has been under way that the shares' states lack."""
        return 0.0


class InTurn(AbstractCrew):
    """Brings one part after the other forward, here: how a run goes on alone that several machines have begun."""

    def cut(self, replicates: int) -> list[int]:
        return [replicates]

    def complete(self, run: "InParts", shares: list[Share], quanta: int, swept: Swept) -> None:
        for at, share in enumerate(shares):
            if share.done:
                continue
            algorithm = run.whole if share.count == run.replicates else run.part(share)
            if share.state is not None:
                algorithm.restore(share.state)
            try:
                algorithm.advance(quanta, swept)
                share = replace(share, done=True)
            finally:
                if algorithm.quanta:
                    shares[at] = replace(share, state=algorithm.capture())


class InParts(AbstractAlgorithm[AbstractState]):
    """Runs an algorithm's stages in parts.

    Args:
        whole: the algorithm of all replicates. It reads states, and results from them.
        crew: brings the parts forward.
        waits: `capture` within a stage returns the state at its beginning, not that of the parts.
    """

    def __init__(self, whole: AbstractAlgorithm, crew: AbstractCrew, *, waits: bool = False):
        super().__init__(whole.geometry, whole.problem, whole.method, whole.seed, whole.replicates)
        self.whole, self.crew, self.before = whole, crew, whole.capture() if waits else None
        self._quanta, self._shares, self._state = 0, list[Share](), None

    @property
    def sizes(self) -> Sizes:
        return self.whole.sizes

    @property
    def quanta(self) -> int:
        return self._quanta

    @property
    def stage_independent(self) -> bool:
        return self.whole.stage_independent

    @property
    def tally(self) -> AbstractTally:
        return self.whole.tally

    def quanta_for(self, lines: float) -> int | None:
        return self.whole.quanta_for(lines)

    def swept_so_far(self) -> int:
        states = [share.state for share in self._shares if share.state is not None]
        return sum(self.tally.swept_lines(self.problem, state) for state in states)

    def behind(self) -> float:
        return self.crew.behind()

    def part(self, share: Share) -> AbstractAlgorithm:
        """Return a new algorithm of a share's replicates."""
        return part_of(self.whole, self.problem, share.first, share.count)

    def advance(self, quanta: int, swept: Swept) -> None:
        self.tally.forget()
        if quanta != self._quanta or not self._shares:
            self._shares = self._cut()
        if self.before is not None and self._state is not None:
            self.before = self._state
        self._quanta, self._state = quanta, None
        self.crew.complete(self, self._shares, quanta, swept)
        # where all is one part, the state may be of a kind that has no parts
        states = [share.state for share in self._shares if share.state is not None]
        self._state = (
            states[0] if len(states) == 1 else merge(states)
        )  # where all is one part, states may be of a kind without parts

    def _cut(self) -> list[Share]:
        """Return the shares of a new stage: as many as suit the crew now, or as before where states cannot be split."""
        counts = self.crew.cut(self.replicates)
        before = [share.count for share in self._shares]
        if self._state is None:
            return _shares(counts, [None] * len(counts))
        if before != counts and not divisible(type(self._state)):
            counts = before or [self.replicates]
        if before == counts:
            return [replace(share, done=False) for share in self._shares]
        return _shares(counts, split(self._state, counts))

    def capture(self) -> AbstractState:
        state = self.before if self._state is None else self._state
        return state or PartsState(sizes=self.sizes, quanta=self._quanta, shares=tuple(self._shares))

    def read(self, arrays: Arrays, sizes: Sizes) -> AbstractState:
        if TABLE not in arrays:
            return self.whole.read(arrays, sizes)
        shares = []
        for at, (first, count, has_state, done) in enumerate(_table(arrays, sizes).tolist()):
            begin, state = PREFIX.format(at), None
            if has_state:
                own = {name[len(begin) :]: value for name, value in arrays.items() if name.startswith(begin)}
                state = self.whole.read(own, replace(sizes, replicates=count))
            shares.append(Share(first, count, state, bool(done)))
        return PartsState(sizes=sizes, quanta=int(arrays["quanta"]), shares=tuple(shares))

    def restore(self, state: AbstractState) -> None:
        self._quanta = state.quanta
        if isinstance(state, PartsState):
            self._shares, self._state = list(state.shares), None
        elif state.unfinished:
            self._shares, self._state = [Share(0, self.replicates, state)], None
        else:
            self._shares, self._state = [Share(0, self.replicates, state, True)], state


def part_of(whole: AbstractAlgorithm, problem: Problem, first: int, count: int) -> AbstractAlgorithm:
    """Return a new algorithm of some of another's replicates."""
    seed = Seed.of(whole.seed)
    return type(whole)(whole.geometry, problem, whole.method, replace(seed, first_replicate=seed.first_replicate + first), count)


def in_parts(arrays: Arrays) -> bool:
    """Return whether arrays of a state are those of parts."""
    return TABLE in arrays


def _shares(counts: list[int], states: list) -> list[Share]:
    firsts = np.cumsum([0, *counts]).tolist()
    return [Share(first, count, state) for first, count, state in zip(firsts, counts, states, strict=False)]


def _table(arrays: Arrays, sizes: Sizes) -> np.ndarray:
    table = np.asarray(arrays[TABLE])
    if table.ndim == 2 and table.shape[1] == 4 and table.dtype.kind in "iu" and len(table):
        ends = np.cumsum(table[:, 1])
        whole = ends[-1] == sizes.replicates and (table[:, 1] > 0).all()
        if whole and np.array_equal(table[:, 0], ends - table[:, 1]):
            return table
    raise MethodError("the solution to go on from lacks parts of its run; start anew")
