"""Incremental stochastic Jacobi iterations: send what was not sent yet, until nothing is left (Shirley 1991; Bekaert 1999).

With N quanta a patch must send E_i A_i N / Phi + rho_i (what it received) quanta of power. A step sends the part of it that was
not sent yet, in one expected line a quantum. When N grows, emission grows and the same counters continue: what a stage adds is an
independent solution with its share of the lines, merged in proportion to them (Feda and Purgathofer 1993).

A stage sends `MOST` quanta at a time, and beyond `EXACT` quanta sums are kept in double precision: whole numbers of 64 bits hold
no more.

Rounding ends the iterations: when less than a line is left it is sent with its probability, in full or not at all. So what is cut
off has no bias, and no threshold is needed.
"""

from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...problem.model import Problem
from ..base import Swept
from .control import SHARE, Control, source_constant
from .exchange import LINE, Exchange
from .polynomials import end_of_polynomials
from .state import IncrementalState

MOST = 1 << 31  # quanta whose power is sent at once; fewer, and `EXACT` too, where their units are finer
EXACT = 1 << 32  # quanta up to which all that arrives on a patch is a whole number


class Incremental:
    """Power received and unsent of all replicates, in units of a quantum / `Exchange.unit`.

    Attributes:
        quanta, begun: N of the stage, and how much of it has been emitted.
        received: (slots * columns,) Int64, all that arrived; Float64 beyond `EXACT` quanta.
        blurred: the same of what elements share out wrongly, see `Exchange.blurred`; None where lines are not refined.
        unsent: (total * columns,) Float64, whole numbers.
        emitted, fired: (replicates, columns) int64, the power that sources gave and that left along lines.
    """

    def __init__(self, exchange: Exchange, problem: Problem, control: Control | None):
        self.exchange, self.control, self.quanta, self.begun = exchange, control, 0, 0
        types = exchange.types
        self.received: Any = upload(types.Int64, np.zeros(exchange.shooter.slots * exchange.columns, np.int64))
        self.blurred: Any = None if exchange.refinement is None else types.Int64(self.received)
        self.unsent = upload(types.Float64, np.zeros(exchange.total * exchange.columns))
        self.emitted, self.fired = (np.zeros((exchange.replicates, exchange.columns), np.int64) for _ in range(2))
        self.probing = 0
        if control is not None:
            groups, area = problem.groups, problem.patches.area
            best = [source_constant(*columns, area) for columns in zip(groups.emission.T, groups.scatter.albedo.T, strict=True)]
            control.beta[:, :: exchange.basis.size] = np.array(best) * area.sum() / problem.source.power

    def advance(self, quanta: int, swept: Swept) -> None:
        """Send all power that patches must send at N quanta."""
        if quanta > self.quanta:
            self.begin(quanta)
        while True:
            while lines := self.step():
                swept(lines)
            if self.begun == self.quanta:
                return
            self._emit()

    def begin(self, quanta: int) -> None:
        """Begin a stage of N quanta."""
        self.quanta = quanta
        self._emit()

    @property
    def exact(self) -> bool:
        """True where power is carried in whole numbers from its source to its end."""
        exchange = self.exchange
        return not exchange.two_ended and self.control is None and exchange.basis.size == 1 and self.quanta <= EXACT // self.finer

    @property
    def finer(self) -> int:
        """How many times as many units a quantum has as it has where lines are not shared out by importance."""
        return self.exchange.unit // LINE

    def _emit(self) -> None:
        """Add emission, up to that of the stage."""
        exchange, types = self.exchange, self.exchange.types
        more = min(self.quanta - self.begun, MOST // self.finer)
        if self.quanta > EXACT // self.finer:
            self.received = types.Float64(self.received)
            self.blurred = None if self.blurred is None else types.Float64(self.blurred)
        source = np.array(exchange.emitted)
        if self.control is not None and self.control.beta.any():
            self.probing = self.control.probe(max(more // SHARE, 1))
            # B - beta solves the equation of the source E - (1 - rho f) beta
            source += np.array(exchange.scattered(self.control.received()) - self.control.constant())
        self.begun += more  # after the probe: where that is stopped between two parts, nothing has been emitted
        new = np.rint(source * (float(more) * exchange.unit))
        self.unsent = upload(types.Float64, np.array(self.unsent) + new)
        if self.quanta <= EXACT // self.finer:
            self.emitted += new.astype(np.int64).reshape(exchange.replicates, exchange.n, exchange.columns).sum(axis=1)

    def step(self) -> int:
        """Make one iteration, and return its number of lines; 0 when all is sent."""
        if self.probing:
            lines, self.probing = self.probing, 0
            return lines
        exchange, types = self.exchange, self.exchange.types
        if not dr.any(self.unsent != 0):
            return 0  # no step is counted: a run that continues here calls this twice
        unsent, expected = self.unsent, exchange.lines_of(self.unsent)
        if exchange.basis.size > 1:
            unsent, expected = end_of_polynomials(exchange, unsent, self.quanta)
        lines, fired = exchange.send(unsent, expected, float(self.begun) * exchange.unit)
        del unsent, expected  # frees their memory
        self.fired += 0 if fired is None or not self.exact else fired()
        self.received += type(self.received)(exchange.shooter.scores.received)
        self.unsent = dr.round(exchange.scattered(types.Float64(exchange.patches(exchange.shooter.scores.received))))
        if self.blurred is not None:
            self.blurred += type(self.blurred)(exchange.blurred)
        dr.eval(self.received, self.unsent, self.blurred)
        return lines

    @property
    def scale(self) -> float:
        """One unit of the received power over Phi."""
        return 1.0 / (float(self.quanta) * self.exchange.unit)

    def capture(self) -> IncrementalState:
        """Return copies of the power."""
        progress = [self.quanta, self.probing, *([self.begun] if self.begun < self.quanta else [])]
        return IncrementalState(
            sizes=self.exchange.sizes,
            received=np.array(self.received),
            unsent=np.array(self.unsent),
            scale=self.scale,
            progress=np.array(progress),
            emitted=self.emitted.copy() if self.exact else None,
            left=self.fired.copy() if self.exact else None,
            blurred=None if self.blurred is None else np.array(self.blurred),
        )

    def restore(self, state: IncrementalState) -> None:
        """Set the power to a captured one."""
        types = self.exchange.types
        self.received = upload(types.Float64 if state.received.dtype.kind == "f" else types.Int64, state.received)
        if self.blurred is not None:
            self.blurred = upload(type(self.received), self.exchange.needed(state.blurred))
        self.unsent = upload(types.Float64, state.unsent)
        self.quanta, self.probing, *begun = (int(x) for x in state.progress)
        self.begun = begun[0] if begun else self.quanta
        if state.emitted is not None and state.left is not None:
            self.emitted, self.fired = state.emitted.copy(), state.left.copy()
