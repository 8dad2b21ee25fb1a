"""Regular stochastic Jacobi iterations: each sends the total power anew, and results are averaged (Neumann et al. 1995).

Iteration k sends P = Pe + rho A_(k-1) with N_k lines and receives R_k. The result is the mean of all R_k, weighted by N_k; with a
control variate by N_k / T_k^2, T_k being the power sent, since that is what their variances go with. The source A takes R_k with
its weight in the result too, but never with less than 1/2: a source that remembers all would keep the error of its first
iterations, which falls as slowly as L^-(1-lambda) with all lines L (docs/iterations.md).

Where both ends score, iterations take two sequences in turn, and there are two sources: iterations of one sequence send what
those of the other received. What is sent then does not depend on the points that it is sent along. Each source takes only every
other iteration, so it forgets more of what it had.

Iterations begin with the light alone, and after k of them the image is too dark by lambda^k. With ``warm_up`` they begin with an
incremental solution instead, which has no bias, so they have none (Bekaert 1999). Without it, the first iterations, until
lambda^k is 1/10 000 or less, are a start-up that the result leaves out (RenderPark has such an option).
"""

from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...errors import MethodError
from ...problem.model import Problem
from ..base import Swept
from .control import Control
from .exchange import LINE, MOST, Exchange
from .incremental import Incremental
from .plan import START, Plan
from .polynomials import least_lines
from .state import RegularState

FORGET = {1: 1 / 2, 2: 7 / 8}  # least weight of an iteration in the source that takes it, by turns
UNIT = 2.0**27  # fixed point units of the mean power of a line
TOTAL = 2.0**58  # fixed point units of Phi / (1 - rho_max), in sums of power


class Regular:
    """Means over the iterations of all replicates.

    Attributes:
        received: (slots * columns,) Float64, the mean of R_k over Phi.
        blurred: the same of `Exchange.blurred`; None where lines are not refined.
        sources: (total * columns,) Float64 each, A over Phi: for each turn, of what steps of the other turn received.
        weights: (replicates,) float64, the sum of the weights of all R_k in the mean.
        constants: (replicates, columns) float64, the mean of beta_k.
        plan: the number of lines of each iteration.
    """

    def __init__(self, exchange: Exchange, problem: Problem, control: Control | None, warm_up: bool):
        self.exchange, self.control, types = exchange, control, exchange.types
        rho, area = problem.groups.scatter.albedo.max(axis=1), problem.patches.area
        self.plan = Plan(least_lines(exchange), min(float(rho @ area / area.sum()), 0.99))
        self.total = TOTAL * (1 - float(rho.max()))
        self.warm = Incremental(exchange, problem, None) if warm_up else None
        self.received = upload(types.Float64, np.zeros(exchange.shooter.slots * exchange.columns))
        self.blurred: Any = None if exchange.refinement is None else types.Float64(self.received)
        self.sources = [upload(types.Float64, np.zeros(exchange.total * exchange.columns)) for _ in range(exchange.turns)]
        self.weights, self.constants = np.zeros(exchange.replicates), np.zeros((exchange.replicates, exchange.columns))

    def advance(self, quanta: int, swept: Swept) -> None:
        """Iterate until a replicate has traced N lines."""
        if quanta > self.plan.quanta:
            self._begin(quanta)
        while not self.plan.over:
            swept(self._next())

    @property
    def quanta(self) -> int:
        return self.plan.quanta

    def _begin(self, quanta: int) -> None:
        plan = self.plan
        if plan.quanta == 0 and self.warm is not None:
            plan.starting = 1
            self.exchange.begin_warm_up()
            self.warm.begin(max(round(quanta / START * (1 - plan.mean)), 1))
        plan.begin(quanta, probes=self.control is not None)

    def _next(self) -> int:
        plan = self.plan
        if plan.probing and self.control is not None:
            lines = min(plan.probing, MOST)
            fired = self.control.probe(lines)
            plan.probing, plan.done = plan.probing - lines, plan.done + lines
            return fired
        if plan.starting and self.warm is not None:
            lines = self.warm.step()
            if lines == 0:
                self._take_over(self.warm)
            return lines
        return self._iterate(plan.lines())

    def _take_over(self, warm: Incremental) -> None:
        """Take the incremental solution as the source, and as part of the result, with the weight of its lines."""
        types, plan = self.exchange.types, self.plan
        lines = round(warm.quanta / (1 - plan.mean))  # not the lines traced: these depend on the solution
        self.received = types.Float64(warm.received) * warm.scale
        if self.blurred is not None:
            self.blurred = types.Float64(warm.blurred) * warm.scale
        self.exchange.end_warm_up()
        source = self.exchange.patches(self.received)
        dr.eval(source, self.received, self.blurred)
        self.sources = [source] * self.exchange.turns
        sent = self._sent(self._largest(self.exchange.emitted + self.exchange.scattered(source)))
        self.weights = self._weight(lines, sent)
        plan.starting, plan.done, plan.summed = 0, plan.done + lines, lines

    def _largest(self, power):
        """Return the power of the largest band of each patch, (total,) UInt64."""
        types = self.exchange.types
        largest = types.UInt64(self.exchange.largest(power) * dr.opaque(types.Float64, self.total))
        dr.eval(largest)
        return largest

    def _sent(self, largest) -> np.ndarray:
        """Return T over Phi, from whole numbers, so that no order matters, (replicates,) float64."""
        return np.maximum(self.exchange.sums(largest), 1).astype(np.float64) / self.total

    def _weight(self, lines: int, sent: np.ndarray) -> np.ndarray:
        """Return the weight of an iteration in the mean, (replicates,) float64."""
        return np.full(len(sent), float(lines)) if self.control is None else lines / sent**2

    def _iterate(self, lines: int) -> int:
        exchange, control, types, turn = self.exchange, self.control, self.exchange.types, self.exchange.turn
        power = exchange.emitted + exchange.scattered(self.sources[turn])
        if control is not None:
            if self.plan.count & (self.plan.count - 1) == 0:  # a median costs a sort
                control.adapt(power)
            power -= control.constant()
        largest = self._largest(power)
        sent = self._sent(largest)
        expected = types.UInt64(types.Float64(largest) * exchange.by_replicate(lines * LINE / (sent * self.total)))
        whole = lines * UNIT / sent
        fired, _ = exchange.send(power * exchange.by_patch(exchange.by_replicate(whole)), expected, whole)
        arrived = types.Float64(exchange.shooter.scores.received) * exchange.by_slot(sent / (lines * UNIT))
        dr.eval(arrived)
        weight = np.ones(exchange.replicates)
        if self.plan.count_iteration(lines):
            weight = self._weight(lines, sent)
            self.weights += weight
            weight /= self.weights
            self.received = dr.lerp(self.received, arrived, exchange.by_slot(weight))
            if self.blurred is not None:
                blurred = types.Float64(exchange.blurred) * exchange.by_slot(1 / whole)
                self.blurred = dr.lerp(self.blurred, blurred, exchange.by_slot(weight))
            if control is not None:
                self.constants += weight[:, None] * (control.beta - self.constants)
        fresh = exchange.patches(arrived) + (0 if control is None else control.received())
        other = (turn + 1) % exchange.turns
        taken = exchange.by_patch(exchange.by_replicate(np.maximum(weight, FORGET[exchange.turns])))
        self.sources[other] = dr.lerp(self.sources[other], fresh, taken)
        dr.eval(self.sources[other], self.received, self.blurred)
        return fired

    def capture(self) -> RegularState:
        """Return copies of the means."""
        warm = self.warm if self.plan.starting else None
        return RegularState(
            sizes=self.exchange.sizes,
            received=np.array(self.received),
            source=np.concatenate(self.sources),
            scale=1.0,
            constants=self.constants.copy(),
            weights=self.weights.copy(),
            progress=self.plan.capture(),
            warm=None if warm is None else warm.capture(),
            blurred=None if self.blurred is None else np.array(self.blurred),
        )

    def restore(self, state: RegularState) -> None:
        """Set the means to captured ones."""
        types = self.exchange.types
        self.plan.restore(state.progress)
        self.received = upload(types.Float64, state.received)
        if self.blurred is not None:
            self.blurred = upload(types.Float64, self.exchange.needed(state.blurred))
        self.sources = [upload(types.Float64, part) for part in np.split(state.source, self.exchange.turns)]
        self.constants, self.weights = state.constants.copy(), state.weights.copy()
        if self.warm is not None and self.plan.starting:
            if state.warm is None:
                raise MethodError("the solution to go on from lacks the warm-up of its iterations; start anew")
            self.exchange.begin_warm_up()
            self.warm.restore(state.warm)
