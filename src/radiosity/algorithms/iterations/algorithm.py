"""Stochastic Jacobi iterations of local lines as an algorithm.

L. Neumann, W. Purgathofer, R. F. Tobler, A. Neumann, P. Elias, M. Feda and X. Pueyo, "The stochastic ray method for
radiosity", Eurographics Rendering Workshop 1995; P. Bekaert, "Hierarchical and stochastic algorithms for radiosity", thesis,
K. U. Leuven 1999.
"""

import numpy as np

from ...device.backend import upload
from ...errors import MethodError
from ...solution.books import exact_sum
from ...tally.shooter import Begun
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
        self._told = 0  # lines of the step that were told of before its end
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

        def of_part(lines: int) -> None:
            self._told += lines
            told(lines)

        def of_step(lines: int) -> None:
            rest, self._told = lines - self._told, 0
            told(rest)

        self.exchange.shooter.told = of_part
        self.scheme.advance(quanta, of_step)
        if self.exchange.shooter.begun is not None:
            raise MethodError("the solution to go on from has lines of a step, and none is left; take an earlier checkpoint")

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
            **self._shot(),
        )

    def _shot(self) -> dict[str, np.ndarray]:
        """Return what a state has of a step whose lines are fired in parts."""
        begun = self.exchange.shooter.begun
        if begun is None:
            return {}
        found = {"shot_done": np.array(begun.done).reshape(self.replicates, -1), "shot_received": np.array(begun.received)}
        return found if begun.moved is None else found | {"shot_moved": np.array(begun.moved)}

    def read(self, arrays: Arrays, sizes: Sizes) -> IterationState:
        wanted = {"incremental" if isinstance(self.scheme, Incremental) else "regular"}
        wanted |= {"fired_apart"} if self.exchange.turns > 1 else set()
        wanted |= {"importance"} if self.importance is not None else set()
        wanted |= {"control"} if self.control is not None else set()
        if not IterationState.lacking(arrays, sizes, wanted):
            state = IterationState.read(arrays, sizes, wanted)
            if state.fits_turns(self.exchange.turns, len(self.exchange.shooter.sequences)):
                state.check_counts()
                return state
        raise MethodError("the solution to go on from lacks the counters of its iterations, or has other sizes; start anew")

    def restore(self, state: IterationState) -> None:
        self.exchange.shooter.write(state.arrivals, state.fired, state.missed, state.fired_apart)
        self.exchange.step, self.importance = state.step, state.importance
        self.exchange.share_out_by(state.importance)
        self._begin_shot(state)
        if self.control is not None and state.control is not None:
            self.control.restore(state.control)
        if isinstance(self.scheme, Incremental):
            assert state.incremental is not None
            self.scheme.restore(state.incremental)
        else:
            assert state.regular is not None
            self.scheme.restore(state.regular)

    def _begin_shot(self, state: IterationState) -> None:
        """Let the next shot go on with the one that had begun, if any."""
        shooter, types, done, received = self.exchange.shooter, self.exchange.types, state.shot_done, state.shot_received
        shooter.begun, self._told = None, 0
        if done is not None and received is not None:
            moved = None if state.shot_moved is None else upload(types.Int64, state.shot_moved)
            shooter.begun = Begun(upload(types.UInt32, np.ravel(done)), upload(types.Int64, received), moved)
            self._told = exact_sum(done)

    @property
    def tally(self) -> IterationTally | RefinedTally:
        plain = IterationTally(self.exchange.basis)
        return plain if self.exchange.refinement is None else RefinedTally(plain)
