"""What a solver is given, what it returns, and when it may stop."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

TOLERANCE = 1e-10


@dataclass(frozen=True, eq=False)
class System:
    """B = E + rho F B.

    Attributes:
        factors: (n, n) scipy CSR array of form factors F_ij, rows sum to 1 or less.
        emission: (n, n_bands) float64, E.
        reflectance: (n, n_bands) float64, rho.
        area: (n,) float64, m².
        tolerance: largest error of the solution, relative to the largest radiosity of its band.
    """

    factors: Any
    emission: np.ndarray
    reflectance: np.ndarray
    area: np.ndarray
    tolerance: float = TOLERANCE

    @cached_property
    def contraction(self) -> float:
        """The largest part of what arrives that any patch sends on: rho times the sum of its row, at most."""
        sums = np.asarray(self.factors.sum(axis=1)).ravel()
        return float((self.reflectance * sums[:, None]).max(initial=0.0))

    def residual(self, radiosity: np.ndarray) -> np.ndarray:
        """(n, n_bands) E + rho F B - B."""
        return self.emission + self.reflectance * (self.factors @ radiosity) - radiosity

    def relative(self, residual: np.ndarray, radiosity: np.ndarray) -> float:
        """The largest residual over the largest radiosity, of the worst band."""
        largest = np.abs(radiosity).max(axis=0, initial=0.0)
        return float((np.abs(residual).max(axis=0, initial=0.0) / np.where(largest > 0, largest, 1)).max(initial=0.0))

    @property
    def enough(self) -> float:
        """A relative residual r leaves an error of r / (1 - contraction) at most (J. Arvo, K. Torrance and B. Smits, "A framework
        for the analysis of error in global illumination algorithms", SIGGRAPH 1994), so this one is small enough; or all that
        double precision gives."""
        return max(self.tolerance * max(1 - self.contraction, 0.0), 64 * float(np.finfo(float).eps))

    @property
    def most_steps(self) -> int:
        """Iterations after which a contraction must have reached `enough`, and some more; no more than a million."""
        if self.contraction <= 0:
            return 8
        if self.contraction >= 1:
            return 10**6
        return min(8 + 2 * int(np.ceil(np.log(self.enough) / np.log(self.contraction))), 10**6)


@dataclass(frozen=True, eq=False)
class Solved:
    """A solution.

    Attributes:
        radiosity: (n, n_bands) float64, B.
        history: (k,) float64, the relative residual after each iteration (of southwell: after every n shots).
    """

    radiosity: np.ndarray
    history: np.ndarray
