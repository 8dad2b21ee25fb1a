"""The firing engine as an algorithm: discrete walks of local lines, in any order."""

from functools import cached_property

import numpy as np

from ...problem.bands import QUANTUM
from ...problem.model import Problem
from ...problem.quanta import Source
from ...solution.books import Books, exact_sum
from ..base import AbstractAlgorithm, AbstractTally, Swept
from ..state import Arrays, Sizes
from . import state as firing_state
from .counters import FiringCounters
from .orders import fire_all
from .residue import Starts
from .residue_walks import LONGER, Sent, send, starts
from .state import FiringState


class Firing(AbstractAlgorithm[FiringState]):
    """The firing engine.

    Its state is integers that do not depend on the order (contract 2), or powers of bands that wavefronts carry (contract 3).
    """

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.counters = FiringCounters(self.geometry, self.problem, self.method, self.seed, self.replicates)

    @property
    def quanta(self) -> int:
        return self.counters.quanta

    @property
    def stage_independent(self) -> bool:
        return self.counters.bands is None

    def advance(self, quanta: int, swept: Swept) -> None:
        self.tally.forget()
        if quanta != self.counters.quanta:
            self.counters.set_quanta(quanta)
        fire_all(self.method.order, self.counters, swept)

    def capture(self) -> FiringState:
        return firing_state.capture(self.counters)

    def read(self, arrays: Arrays, sizes: Sizes) -> FiringState:
        return firing_state.read(arrays, sizes, self.problem.rows.weighed)

    def restore(self, state: FiringState) -> None:
        firing_state.restore(self.counters, state)

    @cached_property
    def tally(self) -> "Arrivals":
        return Arrivals(self.counters, self.problem)


class Arrivals(AbstractTally[FiringState]):
    """Reads hits, each a quantum, or the power of bands that they brought, and what the residue brings (contract 12).

    The residue is sent on when results are read.
    """

    settles = True

    def __init__(self, counters: FiringCounters, problem: Problem):
        self.counters, self.problem = counters, problem
        self.forget()

    def forget(self) -> None:
        self._state: FiringState | None = None
        self._begun: Starts | None = None
        self._sent: Sent | None = None

    def begun(self, state: FiringState) -> Starts:
        """Return the lines that send the residue of a state on, where they begin."""
        if self._begun is None or self._state is not state:
            self.forget()  # first, to free memory
            self._state, self._begun = state, starts(self.counters, self.problem, state)
        return self._begun

    def sent(self, state: FiringState) -> Sent:
        """Return what the residue of a state brings."""
        begun = self.begun(state)
        if self._sent is None:
            self._sent = send(self.counters, self.problem, state, begun)
        return self._sent

    def lines(self, problem: Problem, state: FiringState) -> int:
        return self.swept_lines(problem, state) + self.sent(state).lines

    def swept_lines(self, problem: Problem, state: FiringState) -> int:
        return exact_sum(state.fired)

    def about_lines(self, problem: Problem, state: FiringState) -> float:
        fired, begun = exact_sum(state.fired), self.begun(state)
        packets = self.counters.tracer.replicates * state.quanta
        of_one = fired / max(packets - begun.net, packets / 2)  # the fired power lacks the packets of the residue
        return fired + LONGER * len(begun.line) * of_one

    def arrivals(self, problem: Problem, state: FiringState) -> np.ndarray:
        return state.arrivals[:, : problem.rows.n_patches].sum(axis=0, dtype=np.int64)

    def irradiance(self, problem: Problem, state: FiringState, group: int) -> tuple[np.ndarray, float]:
        received = self.sent(state).received[:, : problem.rows.n_patches, group]
        return received, problem.source.power / state.quanta / QUANTUM

    def books(self, problem: Problem, state: FiringState, group: int) -> dict:
        source, rows, quanta = problem.source, problem.rows, state.quanta
        replicates, sent, bands = len(state.arrivals), self.sent(state), state.bands
        if bands is None:
            missed, fired, unit = [exact_sum(lines) for lines in state.missed], exact_sum(state.fired), QUANTUM
            emitted = source.emitted_in_all(quanta) * replicates * QUANTUM
        else:
            missed = [bands.exact("received_missed", (kind, slice(None), group)) for kind in range(2)]
            fired, unit = bands.exact("fired_power", group), 1
            share = rows.emission[:, group] * rows.area / source.power
            emitted = round(float(share.sum()) * quanta * QUANTUM) * replicates << 32
        arrived, reflected = sent.totals(state, group, Source.fixed_albedo(rows.scatter, group))
        escaped, lost = (count * unit + int(y.sum()) << 32 for count, y in zip(missed, sent.missed[..., group], strict=True))
        fired = fired * unit + sent.fired[group]
        watts = source.power / quanta / QUANTUM / 2**32 / replicates
        most = replicates * len(rows.area) * QUANTUM << 32  # a line of each row; with the residue sent on it is far less
        return Books(emitted, fired << 32, reflected, (arrived << 32) - reflected, escaped, lost, watts, most).powers()
