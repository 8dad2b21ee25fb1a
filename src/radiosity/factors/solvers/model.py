"""The input and output of a solver, and the rule by which it may stop."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...patches.scatter import Scatter

TOLERANCE = 1e-10


@dataclass(frozen=True, eq=False)
class System:
    """The system B = E + rho F B. On diffusing panes tau times what the other side receives is added.

    Attributes:
        factors: (n, n) scipy CSR array of form factors F_ij, rows sum to 1 or less.
        emission: (n, n_bands) float64, E.
        reflectance: (n, n_bands) float64, rho.
        area: (n,) float64, m².
        tolerance: largest error of the solution, relative to the largest radiosity of its band.
        through: (n, n_bands) float64, tau; None where nothing diffuses light.
        other: (n,) int64, the patch on the other side of each; None where nothing diffuses light.
    """

    factors: Any
    emission: np.ndarray
    reflectance: np.ndarray
    area: np.ndarray
    tolerance: float = TOLERANCE
    through: np.ndarray | None = None
    other: np.ndarray | None = None

    @cached_property
    def scatter(self) -> Scatter:
        """What patches send on of the light that they receive."""
        return Scatter(self.reflectance, self.through, self.other)

    @cached_property
    def contraction(self) -> float:
        """Largest of the products of rho and a row sum: an iteration makes the error smaller by this factor, or more."""
        sums = np.asarray(self.factors.sum(axis=1)).ravel()
        return float(self.scatter.of(np.repeat(sums[:, None], self.emission.shape[1], axis=1)).max(initial=0.0))

    def residual(self, radiosity: np.ndarray) -> np.ndarray:
        """Return E + rho F B - B, (n, n_bands)."""
        return self.emission + self.scatter.of(self.factors @ radiosity) - radiosity

    def relative(self, residual: np.ndarray, radiosity: np.ndarray) -> float:
        """Return the largest residual divided by the largest radiosity, of the worst band."""
        largest = np.abs(radiosity).max(axis=0, initial=0.0)
        return float((np.abs(residual).max(axis=0, initial=0.0) / np.where(largest > 0, largest, 1)).max(initial=0.0))

    @property
    def enough(self) -> float:
        """The relative residual that is small enough for the tolerance, or the least that double precision gives.

        A relative residual r leaves an error of r / (1 - contraction) at most (J. Arvo, K. Torrance and B. Smits, "A framework
        for the analysis of error in global illumination algorithms", SIGGRAPH 1994).
        """
        return max(self.tolerance * max(1 - self.contraction, 0.0), 64 * float(np.finfo(float).eps))

    @property
    def most_steps(self) -> int:
        """Iterations that a contraction needs to reach `enough`, and some more; at most a million."""
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
        history: (k,) float64, the relative residual after each iteration (southwell: after every n shots).
    """

    radiosity: np.ndarray
    history: np.ndarray
