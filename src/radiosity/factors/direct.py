"""Irradiance of many emissions at once, by one factorisation of I - F rho.

Where little is absorbed, `solve.irradiance` takes hundreds of steps for each emission. One factorisation takes n³ operations,
whatever is absorbed, and serves all of them.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .model import Factors
from .solve import TOLERANCE, known_lines

MOST = 4096  # patches: their matrices take 400 MB
STEP = 30  # operations of a factorisation that take as long as an iteration does for one factor and emission


def is_quicker(patches: int, factors: int, emissions: int, reflectance: np.ndarray) -> bool:
    """Return whether a factorisation takes less work than iterations, for form factors that reflect so much."""
    largest = float(reflectance.max(initial=0.0))
    if patches > MOST or not 0 < largest < 1:
        return False
    steps = math.log(TOLERANCE * (1 - largest)) / math.log(largest)
    return patches**3 < STEP * steps * factors * emissions


@dataclass(frozen=True, eq=False)
class Direct:
    """A factorised matrix.

    Attributes:
        factors: form factors, rows of which gather.
        reflectance: (n,), in [0, 1).
    """

    factors: Factors
    reflectance: np.ndarray
    _matrix: Any = field(init=False)
    _made: Any = field(init=False)

    def __post_init__(self):
        from scipy.linalg import lu_factor

        n = len(self.reflectance)
        matrix = self.factors.sparse(n)
        system = matrix.toarray()
        system *= -self.reflectance
        system[np.diag_indices(n)] += 1
        object.__setattr__(self, "_matrix", matrix)
        object.__setattr__(self, "_made", lu_factor(system, overwrite_a=True, check_finite=False))

    def irradiance(self, emission: np.ndarray) -> np.ndarray:
        """Return H = F (E + rho H), (n, k), for emissions (n, k)."""
        from scipy.linalg import lu_solve

        return lu_solve(self._made, self._matrix @ emission, overwrite_b=True, check_finite=False)

    def of_own_light(
        self, area: np.ndarray, lines: np.ndarray, emission: np.ndarray, received: np.ndarray, *, both_ways: bool
    ) -> np.ndarray:
        """Return the bias of irradiance, (n, k), see `solve.of_own_light`.

        Args:
            area, lines: (n,).
            emission, received: (n, k).
        """
        factors, rho, n = self.factors, self.reflectance, len(area)
        i, j = factors.rows, factors.columns
        weights = factors.values * rho[j] / known_lines(factors, area, lines, both_ways=both_ways)
        weight = Factors(i, j, weights, factors.escaped, factors.lost).sparse(n)
        own = weight.sum(axis=1)[:, None] * (emission + rho[:, None] * received) - weight @ received
        return np.abs(own + self.irradiance(rho[:, None] * own))
