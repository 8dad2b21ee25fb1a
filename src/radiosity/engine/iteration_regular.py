"""Regular stochastic Jacobi iterations: each sends the total power anew, and results are averaged (Neumann et al. 1995).

Iteration k sends P = Pe + rho A_(k-1) with N_k lines and receives R_k. The result is the mean of all R_k, weighted by N_k. The
source A takes R_k with weight N_k / sum N too, but never with less than 1/2: a source that remembers all would keep the error of
its first iterations, which falls as slowly as L^-(1-lambda) with all lines L (docs/iterations.md).

Iterations begin at the light alone, whose image is too dark by lambda^k after k of them. With ``warm_up`` they begin at an
incremental solution instead, which has no bias, and neither have they (Bekaert 1999). Without it, the first iterations, until
lambda^k is 1/1000 or less, are a start-up that the result leaves out (RenderPark has such an option).
"""

import math

import numpy as np

from .device import upload
from .iteration_control import SHARE, Control
from .iteration_exchange import LINE, Exchange
from .iteration_incremental import Incremental
from .problem import Problem
from .process import State, Swept

START = 4  # one line in so many of the first stage is for the start
FORGET = 0.5  # least weight of the last iteration in the source
DARK = 1e-3  # share of the light that may be missing when the start-up ends
UNIT = 2.0**27  # of received power: a line that carries Phi / (1 - rho_max)
TOTAL = 2.0**58  # of sums of power, likewise
FEWEST = 1024  # lines of an iteration, and one a patch


class Regular:
    """Sums of the iterations of all replicates.

    Attributes:
        received: (slots * groups,) Int64, sum of N_k R_k in units of ``unit``.
        source: (total * groups,) Float64, A over Phi.
        summed: sum of N_k over the iterations that the result holds.
        constants: (replicates, groups) float64, sum of N_k beta_k.
        quanta, done: lines of a replicate, to be traced in this stage and traced.
        starting, start_lines: iterations of the start-up that are left, and the lines of each.
        begin_left: lines of this stage that are to be fired for the control variate.
    """

    def __init__(self, exchange: Exchange, problem: Problem, control: Control | None, warm_up: bool):
        self.exchange, self.control, types = exchange, control, exchange.types
        rho, area = problem.groups.reflectance.max(axis=1), problem.patches.area
        self.mean = min(float(rho @ area / area.sum()), 0.99)
        self.bound = 1 - float(rho.max())
        self.unit = UNIT * self.bound
        self.warm = Incremental(exchange, problem, None) if warm_up else None
        self.received = upload(types.Int64, np.zeros(exchange.shooter.slots * exchange.groups, np.int64))
        self.source = upload(types.Float64, np.zeros(exchange.total * exchange.groups))
        self.constants = np.zeros((exchange.replicates, exchange.groups))
        self.quanta = self.done = self.summed = self.count = self.starting = self.start_lines = self.begin_left = 0

    def advance(self, quanta: int, swept: Swept) -> None:
        """Iterate until a replicate has traced N lines."""
        if quanta > self.quanta:
            self._begin(quanta)
        while self.done < self.quanta:
            swept(self._next())

    def _begin(self, quanta: int) -> None:
        if self.quanta == 0:
            budget = max(quanta // START, 1)
            if self.warm is not None:
                self.warm.begin(max(round(budget * (1 - self.mean)), 1))
                self.starting = 1
            else:
                self.starting = max(1, math.ceil(math.log(DARK) / math.log(max(self.mean, DARK))))
                self.start_lines = max(1, min(budget // self.starting, 10 * self.exchange.n))
        self.begin_left = max((quanta - self.quanta) // SHARE, 1) if self.control is not None else 0
        self.quanta = quanta

    def _next(self) -> int:
        if self.begin_left and self.control is not None:
            lines, self.begin_left = self.begin_left, 0
            self.done += lines
            return self.control.probe(lines)
        if self.starting and self.warm is not None:
            lines = self.warm.step()
            if lines == 0:
                self._take_over(self.warm)
            return lines
        if self.starting:
            self.starting -= 1
            self.done += self.start_lines
            return self._iterate(self.start_lines, kept=False)
        lines = self._lines()
        self.done += lines
        return self._iterate(lines, kept=True)

    def _lines(self) -> int:
        """Of the next iteration: one a patch at least, then a share of all so far, so that between L and 2 L lines there are
        enough iterations for an error of the source to die out, and few enough to be cheap."""
        wanted = max(self.exchange.n, FEWEST, self.summed // min(max(8, round(4 / (1 - self.mean))), 128))
        left = self.quanta - self.done
        return left if left < 1.5 * wanted else wanted

    def _take_over(self, warm: Incremental) -> None:
        """The incremental solution becomes the source, and part of the result, with the weight of its lines."""
        import drjit as dr

        types, self.starting = self.exchange.types, 0
        lines = round(warm.quanta / (1 - self.mean))  # not the lines traced: these depend on the solution
        self.source = types.Float64(self._patches(warm.received)) * warm.scale
        self.received = types.Int64(dr.round(types.Float64(warm.received) * (warm.scale * lines * self.unit)))
        dr.eval(self.source, self.received)
        self.done, self.summed = self.done + lines, lines

    def _patches(self, received):
        import drjit as dr

        return dr.gather(self.exchange.types.Int64, received, dr.arange(self.exchange.types.UInt32, dr.width(self.source)))

    def _iterate(self, lines: int, *, kept: bool) -> int:
        import drjit as dr

        exchange, control, types = self.exchange, self.control, self.exchange.types
        power = exchange.emitted + exchange.rho * self.source
        if control is not None:
            if self.count & (self.count - 1) == 0:  # a median costs a sort
                control.adapt(power)
            power -= control.constant()
        largest = types.UInt64(exchange.largest(power) * dr.opaque(types.Float64, TOTAL * self.bound))
        total = np.maximum(exchange.sums(largest), 1).astype(np.float64)
        expected = types.UInt64(types.Float64(largest) * exchange.by_replicate(float(lines) * LINE / total))
        fired, _ = exchange.send(power * dr.opaque(types.Float64, lines * self.unit), expected)
        arrived = types.Float64(exchange.arrived()) * dr.opaque(types.Float64, 1 / (lines * self.unit))
        if control is not None:
            arrived += control.received()
        self.count += 1
        weight = 1.0
        if kept:
            self.summed += lines
            weight = max(lines / self.summed, FORGET)
            self.received += exchange.shooter.received
            self.constants += 0 if control is None else lines * control.beta
        self.source = dr.lerp(self.source, arrived, dr.opaque(types.Float64, weight))
        dr.eval(self.source, self.received)
        return fired

    @property
    def scale(self) -> float:
        """Of the received power: one unit over Phi."""
        return 1.0 / (max(self.summed, 1) * self.unit)

    def capture(self) -> State:
        numbers = [self.quanta, self.done, self.summed, self.count, self.starting, self.start_lines, self.begin_left]
        state = {"received": np.array(self.received), "source": np.array(self.source), "scale": np.array(self.scale)}
        state |= {"constants": self.constants / max(self.summed, 1), "progress": np.array(numbers)}
        if self.warm is not None and self.starting:
            state |= {f"warm_{key}": value for key, value in self.warm.capture().items()}
        return state

    def restore(self, state: State) -> None:
        types, numbers = self.exchange.types, (int(x) for x in state["progress"])
        self.quanta, self.done, self.summed, self.count, self.starting, self.start_lines, self.begin_left = numbers
        self.received = upload(types.Int64, state["received"])
        self.source = upload(types.Float64, state["source"])
        self.constants = state["constants"] * max(self.summed, 1)
        if self.warm is not None and self.starting:
            self.warm.restore({key.removeprefix("warm_"): value for key, value in state.items() if key.startswith("warm_")})
