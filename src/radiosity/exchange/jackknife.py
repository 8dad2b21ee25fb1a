"""Means and standard errors of what is solved for with all lines, from solutions without one replicate each.

Watts and temperatures are not linear in the counts, so that those of few lines are off by a bias of the order of one over the
lines. The solution of all lines together has the smallest. What is left of it shows where one replicate is left out, and is
subtracted; the same solutions give the standard error (M. H. Quenouille, "Notes on bias in estimation", Biometrika 43, 1956).
"""

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Jackknife:
    """Sums over solutions. Give the solution of all replicates first.

    Attributes:
        whole: value of all replicates together.
    """

    whole: np.ndarray
    number: int = 0
    total: np.ndarray = field(init=False)
    squares: np.ndarray = field(init=False)

    def __post_init__(self):
        self.total, self.squares = np.zeros(self.whole.shape), np.zeros(self.whole.shape)

    def add(self, value: np.ndarray) -> None:
        """Add the value without one replicate."""
        off = value - self.whole
        self.number += 1
        self.total += off
        self.squares += off**2

    @property
    def bias(self) -> np.ndarray:
        """Estimated bias of ``whole``; zero of a single replicate."""
        return (self.number - 1) * self.total / self.number if self.number else np.zeros(self.whole.shape)

    @property
    def value(self) -> np.ndarray:
        """The value less its bias."""
        return self.whole - self.bias

    @property
    def error(self) -> np.ndarray:
        """Standard error; NaN of a single replicate: unknown."""
        if self.number < 2:
            return np.full(self.whole.shape, np.nan)
        spread = np.maximum(self.squares - self.total**2 / self.number, 0)
        return np.sqrt((self.number - 1) / self.number * spread)
