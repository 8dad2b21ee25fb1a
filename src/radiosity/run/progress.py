"""Progress of a run: what listeners are told while it goes on, and how Ctrl-C stops it."""

import math
import signal
import threading
import time
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass

from ..device.turn import aside
from .budget import DONE, Budget

SLOPE = 0.6  # of the error against lines, as measured with low discrepancy numbers
LAST = 4  # stages from which a run's own slope is taken
FLATTEST, STEEPEST = 0.35, 1.0


@dataclass(frozen=True)
class Progress:
    """A moment of a run.

    Attributes:
        stage: the number of complete stages.
        rays: lines of wavefronts so far, replicates together; lines that send the residue on follow when results are read.
        rays_per_second: lines a second since the first wavefront began.
        error: relative error after the last complete stage, NaN where unknown.
        fraction: of the budget, 0 to 1, or None where it is not known yet.
        seconds_left: an estimate, or None.
        message: what is being done.
    """

    stage: int
    rays: int
    rays_per_second: float
    error: float
    fraction: float | None
    seconds_left: float | None
    message: str


Listener = Callable[[Progress], None]


class Teller:
    """The counter of a run's lines, which tells a listener how far the run is.

    Args:
        seconds: that the run has taken already.
    """

    def __init__(self, budget: Budget, listener: Listener | None, seconds: float = 0.0):
        self.budget, self.listener = budget, listener
        self.tracing_since = time.perf_counter()
        self.begun = self.tracing_since - seconds
        self.stage, self.lines, self.lines_before, self.error, self.bound = 0, 0, 0, math.nan, math.nan
        self.lines_a_quantum = 0.0
        self.known: list[tuple[float, float]] = []  # logarithms to base 2 of lines and error after each stage

    @property
    def elapsed(self) -> float:
        return time.perf_counter() - self.begun

    def begin(self, lines: int) -> None:
        """Note that tracing begins, after ``lines`` of an earlier run."""
        self.tracing_since, self.lines, self.lines_before = time.perf_counter(), lines, lines

    def complete(self, lines: int, quanta: int, error: float, margin: float = 1.0, swept: int | None = None) -> None:
        """Note that a stage is complete.

        Args:
            error, margin: the true error may be ``margin`` times the stated one (NaN: unknown).
            swept: lines that were told; all of them by default.
        """
        swept = lines if swept is None else swept
        self.bound = error * margin
        self.stage, self.lines, self.error, self.lines_a_quantum = self.stage + 1, swept, error, swept / quanta
        if error > 0 and lines > 0:
            self.known.append((math.log2(lines), math.log2(error)))

    @property
    def slope(self) -> float:
        """Slope of the error against lines, a positive power.

        It is a least squares fit to this run's last stages, drawn towards `SLOPE` as if by one more doubling.
        """
        last = self.known[-LAST:]
        if len(last) < 2:
            return SLOPE
        x, y = ([value - sum(column) / len(last) for value in column] for column in zip(*last, strict=True))
        spread = sum(a * a for a in x)
        slope = (SLOPE * 0.5 - sum(a * b for a, b in zip(x, y, strict=True))) / (0.5 + spread)
        return min(max(slope, FLATTEST), STEEPEST)

    def tell(self, message: str) -> None:
        """Tell the listener."""
        if self.listener is None:
            return
        tracing = time.perf_counter() - self.tracing_since
        rate = (self.lines - self.lines_before) / tracing if tracing > 0 else 0.0
        fraction, left = self._ahead(rate)
        moment = Progress(
            self.stage,
            self.lines,
            rate,
            self.error,
            None if fraction is None else min(max(fraction, 0.0), 1.0),
            None if left is None else max(left, 0.0),
            message,
        )
        with aside():
            self.listener(moment)

    def _ahead(self, rate: float) -> tuple[float | None, float | None]:
        """Return the fraction that is done, and the seconds left; for an error with a limit, by what comes first."""
        fractions, lefts = [], []
        if self.budget.seconds is not None:
            fractions.append(self.elapsed / self.budget.seconds)
            lefts.append(self.budget.seconds - self.elapsed)
        for whole in (self.budget.rays, self._expected_lines()):
            if whole:
                fractions.append(self.lines / whole)
                lefts += [(whole - self.lines) / rate] if rate else []
        return max(fractions, default=None), min(lefts, default=None)

    def _expected_lines(self) -> float | None:
        """Return the expected lines of a run to N quanta, or to an error; None where nothing is known yet."""
        if self.budget.quanta == DONE:
            return None
        if self.budget.quanta is not None:
            return self.lines_a_quantum * self.budget.quanta or None
        if self.budget.error is None or not self.bound > 0:
            return None
        return max(self.lines, self.lines * (self.bound / self.budget.error) ** (1 / self.slope))


class Stop:
    """A request to stop. Ctrl-C sets it; it is read between wavefronts, where counters are whole. A second one stops at once."""

    def __init__(self):
        self.asked = False

    @contextmanager
    def listening(self):
        """Handle SIGINT in the main thread during a block."""
        if threading.current_thread() is not threading.main_thread():
            yield self
            return
        before = signal.getsignal(signal.SIGINT)

        def handle(number, frame):
            if self.asked:
                raise KeyboardInterrupt
            self.asked = True

        signal.signal(signal.SIGINT, handle)
        try:
            yield self
        finally:
            signal.signal(signal.SIGINT, before)
