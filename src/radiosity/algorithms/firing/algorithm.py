"""The firing engine as a process: discrete walks of local lines, in any order."""

from functools import cached_property

import numpy as np

from ...problem.bands import QUANTUM
from ...problem.model import Problem
from ...problem.quanta import Source
from ...solution.books import Books, exact_sum, signed_totals
from ..base import AbstractAlgorithm, AbstractTally, State, Swept
from . import state as counters
from .counters import Engine
from .orders import run as fire_all
from .residue import Starts
from .residue_walks import LONGER, Sent, send, starts


class Firing(AbstractAlgorithm):
    """Integers that do not depend on order (contract 2), or powers of bands that travel with sweeps (contract 3)."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.engine = Engine(self.geometry, self.problem.source, self.method, self.seed, self.replicates, self.problem.groups)

    @property
    def quanta(self) -> int:
        return self.engine.quanta

    @property
    def stage_independent(self) -> bool:
        return self.engine.bands is None

    def advance(self, quanta: int, swept: Swept) -> None:
        self.tally.forget()
        if quanta != self.engine.quanta:
            self.engine.set_quanta(quanta)
        fire_all(self.method.order, self.engine, swept)

    def capture(self) -> State:
        return counters.capture(self.engine)

    def restore(self, state: State) -> None:
        counters.restore(self.engine, state)

    def unfinished(self, state: State) -> bool:
        return "within" in state

    @cached_property
    def tally(self) -> "Arrivals":
        return Arrivals(self.engine, self.problem)


class Arrivals(AbstractTally):
    """Arrivals, each a quantum, or the power of bands that they brought; and what the residue brings (contract 12), which is sent
    on where results are read."""

    settles = True

    def __init__(self, engine: Engine, problem: Problem):
        self.engine, self.problem = engine, problem
        self.forget()

    def forget(self) -> None:
        self._state: State | None = None
        self._begun: Starts | None = None
        self._sent: Sent | None = None

    def begun(self, state: State) -> Starts:
        """Where lines begin that send the residue of a state on."""
        if self._begun is None or self._state is not state:
            self.forget()  # first, for the sake of memory
            self._state, self._begun = state, starts(self.engine, self.problem, state)
        return self._begun

    def sent(self, state: State) -> Sent:
        """What the residue of a state brings."""
        begun = self.begun(state)
        if self._sent is None:
            self._sent = send(self.engine, self.problem, state, begun)
        return self._sent

    def lines(self, problem: Problem, state: State) -> int:
        return self.swept_lines(problem, state) + self.sent(state).lines

    def swept_lines(self, problem: Problem, state: State) -> int:
        return exact_sum(state["fired"])

    def about_lines(self, problem: Problem, state: State) -> float:
        fired, begun = exact_sum(state["fired"]), self.begun(state)
        packets = self.engine.replicates * int(state["quanta"])
        of_one = fired / max(packets - begun.net, packets / 2)  # what is fired lacks those of the residue
        return fired + LONGER * len(begun.line) * of_one

    def arrivals(self, problem: Problem, state: State) -> np.ndarray:
        return state["arrivals"].sum(axis=0, dtype=np.int64)

    def irradiance(self, problem: Problem, state: State, group: int) -> tuple[np.ndarray, float]:
        return self.sent(state).received[..., group], problem.source.power / int(state["quanta"]) / QUANTUM

    def books(self, problem: Problem, state: State, group: int) -> dict:
        source, groups, quanta = problem.source, problem.groups, int(state["quanta"])
        replicates, sent = len(state["arrivals"]), self.sent(state)
        if "received" not in state:
            missed, fired, unit = state["missed"], exact_sum(state["fired"]), QUANTUM
            emitted = source.emitted_in_all(quanta) * replicates * QUANTUM
        else:
            missed, fired, unit = state["received_missed"][..., group], exact_sum(state["fired_power"][group]), 1
            share = groups.emission[:, group] * problem.patches.area / source.power
            emitted = round(float(share.sum()) * quanta * QUANTUM) * replicates << 32
        arrived, reflected = signed_totals(sent.received[..., group], Source.fixed(groups.reflectance[:, group]))
        escaped, lost = (exact_sum(x) * unit + int(y.sum()) << 32 for x, y in zip(missed, sent.missed[..., group], strict=True))
        fired = fired * unit + sent.fired[group]
        watts = source.power / quanta / QUANTUM / 2**32 / replicates
        return Books(emitted, fired << 32, reflected, (arrived << 32) - reflected, escaped, lost, watts).powers()
