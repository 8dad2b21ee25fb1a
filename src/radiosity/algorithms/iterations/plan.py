"""The plan of regular iterations, how many lines each fires: first a start, then ever longer iterations."""

import math

import numpy as np

from .control import SHARE
from .exchange import MOST

START = 4  # one line in 4 of the first stage is for the start
DARK = 1e-4  # share of the light that may be missing when the start-up ends
FEWEST = 1024  # least lines of an iteration, besides one a patch
COUNTERS = ("quanta", "done", "summed", "count", "starting", "start_lines", "probing")


class Plan:
    """Counters of a replicate; they are the same for all replicates.

    Attributes:
        n: the least lines of an iteration: the number of patches, or more where lines carry polynomials.
        mean: the mean reflectance, about the factor by which light falls from bounce to bounce.
        quanta, done: lines to trace up to the end of this stage, and lines traced so far.
        summed, count: lines of the iterations in the mean, and the number of these iterations.
        starting, start_lines: iterations of the start-up that are left (1 during a warm-up), and the lines of each.
        probing: lines of this stage that are left to fire for the control variate.
    """

    def __init__(self, n: int, mean: float):
        self.n, self.mean = n, mean
        self.quanta = self.done = self.summed = self.count = self.starting = self.start_lines = self.probing = 0

    def begin(self, quanta: int, *, probes: bool) -> None:
        """Begin a stage of N lines. The first also plans the start, unless one is under way."""
        if self.quanta == 0 and not self.starting:
            self.starting = max(1, math.ceil(math.log(DARK) / math.log(max(self.mean, DARK))))
            self.start_lines = max(1, min(quanta // START // self.starting, 10 * self.n))
        self.probing = max((quanta - self.quanta) // SHARE, 1) if probes else 0
        self.quanta = quanta

    def lines(self) -> int:
        """Return the number of lines of the next iteration.

        It is at least one a patch, then a share of all lines so far. So between L and 2 L lines there are enough iterations for
        an error of the source to vanish, and few enough to be cheap. A stage whose lines the start used up gets one more
        iteration, of the lines that the start should have left.
        """
        if self.starting:
            return self.start_lines
        wanted = min(max(self.n, FEWEST, self.summed // min(max(8, round(4 / (1 - self.mean))), 128)), MOST)
        left = self.quanta - self.done
        if left <= 0:  # the start took the whole first stage
            return max(self.quanta - self.quanta // START, 1)
        return left if left < 1.5 * wanted else wanted

    @property
    def over(self) -> bool:
        """True where the stage is complete: its lines are traced, and an iteration is in the mean."""
        return self.done >= self.quanta and self.summed > 0

    def count_iteration(self, lines: int) -> bool:
        """Count a complete iteration, and return whether it is part of the result."""
        self.done, self.count = self.done + lines, self.count + 1
        if self.starting:
            self.starting -= 1
            return False
        self.summed += lines
        return True

    def capture(self) -> np.ndarray:
        return np.array([getattr(self, name) for name in COUNTERS])

    def restore(self, values: np.ndarray) -> None:
        for name, value in zip(COUNTERS, values, strict=True):
            setattr(self, name, int(value))
