"""Stochastic Jacobi iterations of local lines as an algorithm.

L. Neumann, W. Purgathofer, R. F. Tobler, A. Neumann, P. Elias, M. Feda and X. Pueyo, "The stochastic ray method for
radiosity", Eurographics Rendering Workshop 1995; P. Bekaert, "Hierarchical and stochastic algorithms for radiosity", thesis,
K. U. Leuven 1999.
"""

from ...errors import MethodError
from ..base import AbstractAlgorithm, Interrupted, Swept
from ..state import Arrays, Sizes
from .control import Control
from .exchange import Exchange
from .incremental import Incremental
from .refined_tally import RefinedTally
from .regular import Regular
from .state import IncrementalState, IterationState, RegularState
from .tally import IterationTally


class Iteration(AbstractAlgorithm[IterationState]):
    """Runs the orders ``incremental`` and ``regular``, which send power in the same way, but not the same power."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        method = self.method
        if method.estimator == "bidirectional" and self.geometry.some_backs_pass:
            raise MethodError(
                f"{self.problem.patches.scene.source}: some backs let lines pass, which makes what a patch sees different from "
                "what sees the patch; estimator 'bidirectional' needs them equal: take collision"
            )
        self.exchange = Exchange(self.geometry, self.problem, method, self.seed, self.replicates)
        self.importance = self.problem.shares
        self.control = Control(self.exchange) if method.control_variate else None
        if method.order == "incremental":
            self.scheme: Incremental | Regular = Incremental(self.exchange, self.problem, self.control)
        else:
            self.scheme = Regular(self.exchange, self.problem, self.control, method.warm_up)

    @property
    def quanta(self) -> int:
        return self.scheme.quanta

    @property
    def sizes(self) -> Sizes:
        return self.exchange.sizes

    @property
    def stage_independent(self) -> bool:
        return False

    def advance(self, quanta: int, swept: Swept) -> None:
        shots = self.exchange.shooter.elsewhere

        def told(lines: int) -> None:
            swept(lines)
            if shots is not None and shots.over:
                raise Interrupted("interrupted")

        self.scheme.advance(quanta, told)

    def capture(self) -> IterationState:
        scheme = self.scheme.capture()
        arrivals, fired, missed, apart = self.exchange.shooter.read()
        return IterationState(
            sizes=self.sizes,
            quanta=self.quanta,
            arrivals=arrivals,
            fired=fired,
            missed=missed,
            fired_apart=apart,
            step=self.exchange.step,
            importance=self.importance,
            regular=scheme if isinstance(scheme, RegularState) else None,
            incremental=scheme if isinstance(scheme, IncrementalState) else None,
            control=None if self.control is None else self.control.capture(),
        )

    def read(self, arrays: Arrays, sizes: Sizes) -> IterationState:
        wanted = {"incremental" if isinstance(self.scheme, Incremental) else "regular"}
        wanted |= {"fired_apart"} if self.exchange.turns > 1 else set()
        wanted |= {"importance"} if self.importance is not None else set()
        wanted |= {"control"} if self.control is not None else set()
        if not IterationState.lacking(arrays, sizes, wanted):
            state = IterationState.read(arrays, sizes, wanted)
            if state.fits_turns(self.exchange.turns, self.exchange.shooter.sequences):
                return state
        raise MethodError("the solution to go on from lacks the counters of its iterations, or has other sizes; start anew")

    def restore(self, state: IterationState) -> None:
        self.exchange.shooter.write(state.arrivals, state.fired, state.missed, state.fired_apart)
        self.exchange.step, self.importance = state.step, state.importance
        self.exchange.share_out_by(state.importance)
        if self.control is not None and state.control is not None:
            self.control.restore(state.control)
        if isinstance(self.scheme, Incremental):
            assert state.incremental is not None
            self.scheme.restore(state.incremental)
        else:
            assert state.regular is not None
            self.scheme.restore(state.regular)

    @property
    def tally(self) -> IterationTally | RefinedTally:
        plain = IterationTally(self.exchange.basis)
        return plain if self.exchange.refinement is None else RefinedTally(plain)
