"""Stochastic Jacobi iterations of local lines as a process.

L. Neumann, W. Purgathofer, R. F. Tobler, A. Neumann, P. Elias, M. Feda and X. Pueyo, "The stochastic ray method for
radiosity", Eurographics Rendering Workshop 1995; P. Bekaert, "Hierarchical and stochastic algorithms for radiosity", thesis,
K. U. Leuven 1999.
"""

import numpy as np

from ...errors import MethodError
from ..base import AbstractAlgorithm, State, Swept
from .control import Control
from .exchange import Exchange
from .incremental import Incremental
from .regular import Regular
from .tally import IterationTally


class Iteration(AbstractAlgorithm):
    """Orders ``incremental`` and ``regular``, which share how power is sent, and differ in what is."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        method = self.method
        if method.estimator == "bidirectional" and self.geometry.some_backs_pass:
            raise MethodError(
                f"{self.problem.patches.scene.source}: some backs let lines pass, which makes what a patch sees different from "
                "what sees the patch; estimator 'bidirectional' needs them equal: take collision"
            )
        self.exchange = Exchange(self.geometry, self.problem, method, self.seed, self.replicates)
        self.control = Control(self.exchange) if method.control_variate else None
        if method.order == "incremental":
            self.scheme: Incremental | Regular = Incremental(self.exchange, self.problem, self.control)
        else:
            self.scheme = Regular(self.exchange, self.problem, self.control, method.warm_up)

    @property
    def quanta(self) -> int:
        return self.scheme.quanta

    @property
    def stage_independent(self) -> bool:
        return False

    def advance(self, quanta: int, swept: Swept) -> None:
        self.scheme.advance(quanta, swept)

    def capture(self) -> State:
        state = self.exchange.shooter.capture() | self.scheme.capture()
        state |= {"quanta": np.array(self.quanta), "step": np.array(self.exchange.step)}
        return state if self.control is None else state | self.control.capture()

    def restore(self, state: State) -> None:
        shape = (self.replicates, self.exchange.n)
        counters = {"progress", "fired"} | ({"fired_apart"} if self.exchange.turns > 1 else set())
        if counters - set(state) or state["fired"].shape != shape:
            raise MethodError("the solution to go on from lacks the counters of its iterations, or has other sizes; start anew")
        self.exchange.shooter.restore(state)
        self.exchange.step = int(state["step"])
        if self.control is not None:
            self.control.restore(state)
        self.scheme.restore(state)

    def unfinished(self, state: State) -> bool:
        if "unsent" in state:
            return bool(state["unsent"].any())
        quanta, done, summed = (int(x) for x in state["progress"][:3])
        return done < quanta or summed == 0

    @property
    def tally(self) -> IterationTally:
        return IterationTally()
