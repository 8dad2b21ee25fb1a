"""The ambient term, and the tally of progressive refinement."""

from dataclasses import dataclass

import numpy as np

from ...problem.model import Problem
from ..base import AbstractTally
from ..baseline_tally import SolvedTally
from .state import ProgressiveState


def ambient(area: np.ndarray, albedo: np.ndarray, unshot: np.ndarray) -> np.ndarray:
    """Return the ambient irradiance, (groups,), the same everywhere: what light not shot yet will bring if it spreads evenly.

    It is the sum of A dB over the sum of (1 - rho) A, which balances what it brings with what is absorbed (Cohen et al. 1988,
    equation 6).
    """
    absorbs = area @ (1 - albedo)
    return np.divide(area @ unshot, absorbs, out=np.zeros(unshot.shape[1]), where=absorbs > 0)


@dataclass(frozen=True, eq=False)
class ProgressiveTally(AbstractTally[ProgressiveState]):
    """Reads states as `SolvedTally` does. With ``ambient`` it adds the ambient term to the irradiance.

    The energy balance leaves the ambient term out: it is for display.
    """

    ambient: bool
    solved: SolvedTally

    counts_hits = False

    def lines(self, problem: Problem, state: ProgressiveState) -> int:
        return self.solved.lines(problem, state)

    def arrivals(self, problem: Problem, state: ProgressiveState) -> np.ndarray:
        return self.solved.arrivals(problem, state)

    def irradiance(self, problem: Problem, state: ProgressiveState, group: int) -> tuple[np.ndarray, float]:
        values, unit = self.solved.irradiance(problem, state, group)
        if not self.ambient:
            return values, unit
        area = problem.patches.area
        return values + area * ambient(area, problem.groups.scatter.albedo, state.unshot)[group], unit

    def books(self, problem: Problem, state: ProgressiveState, group: int) -> dict:
        return self.solved.books(problem, state, group)
