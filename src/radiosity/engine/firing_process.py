"""The firing engine as a process: discrete walks of local lines, in any order."""

import numpy as np

from ..method.order import run as fire_all
from ..solution.books import Books, exact_sum, exact_totals
from . import state as counters
from .bands import QUANTUM
from .firing import Engine
from .problem import Problem
from .process import AbstractProcess, AbstractTally, State, Swept
from .quanta import Source


class Firing(AbstractProcess):
    """Integers that do not depend on order (contract 2), or powers of bands that travel with sweeps (contract 3)."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.engine = Engine(self.geometry, self.problem.source, self.method, self.seed, self.replicates, self.problem.groups)

    @property
    def quanta(self) -> int:
        return self.engine.quanta

    @property
    def nested(self) -> bool:
        return self.engine.bands is None

    def advance(self, quanta: int, swept: Swept) -> None:
        if quanta != self.engine.quanta:
            self.engine.set_quanta(quanta)
        fire_all(self.method.order, self.engine, swept)

    def capture(self) -> State:
        return counters.capture(self.engine)

    def restore(self, state: State) -> None:
        counters.restore(self.engine, state)

    def unfinished(self, state: State) -> bool:
        return "before" in state

    @property
    def tally(self) -> "Arrivals":
        return Arrivals()


class Arrivals(AbstractTally):
    """Arrivals, each a quantum; or the power of bands that they brought."""

    settles = True

    def lines(self, problem: Problem, state: State) -> int:
        return int(state["fired"].sum(dtype=np.uint64))

    def arrivals(self, problem: Problem, state: State) -> np.ndarray:
        return state["arrivals"].sum(axis=0, dtype=np.int64)

    def irradiance(self, problem: Problem, state: State, group: int) -> tuple[np.ndarray, float]:
        unit = problem.source.power / int(state["quanta"])
        if "received" in state:
            return state["received"][..., group], unit / QUANTUM
        return state["arrivals"], unit

    def books(self, problem: Problem, state: State, group: int) -> dict:
        source, groups, quanta = problem.source, problem.groups, int(state["quanta"])
        replicates = len(state["arrivals"])
        if "received" not in state:
            counts, missed, fired, unit = state["arrivals"], state["missed"], exact_sum(state["fired"]), 1
            emitted = source.emitted_in_all(quanta) * replicates
        else:
            counts, missed, unit = state["received"][..., group], state["received_missed"][..., group], QUANTUM
            fired = exact_sum(state["fired_power"][group])
            share = groups.emission[:, group] * problem.patches.area / source.power
            emitted = round(float(share.sum()) * quanta * QUANTUM) * replicates << 32
        rho = Source.fixed(groups.reflectance[:, group])
        arrived, reflected = exact_totals(counts, rho)
        watts = source.power / quanta / unit / 2**32 / replicates
        escaped, lost = (exact_sum(x) << 32 for x in missed)
        return Books(emitted, fired << 32, reflected, (arrived << 32) - reflected, escaped, lost, watts).powers()
