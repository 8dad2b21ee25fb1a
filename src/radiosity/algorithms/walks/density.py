"""Hits of particles, reconstructed by local linear fits."""

from dataclasses import dataclass, field

import numpy as np

from ...problem.model import Problem
from ...solution.books import by_difference
from ...solution.smoothing import Smoother
from ..base import AbstractBiasedTally, AbstractTally
from .state import WalkState


@dataclass(frozen=True)
class DensityTally(AbstractBiasedTally[WalkState]):
    """Smooths the powers of another tally, each replicate by itself, with the bandwidths of all hits together.

    Attributes:
        counted: the tally that reads the hits.
    """

    counted: AbstractTally[WalkState]
    _known: dict = field(default_factory=dict, compare=False)

    def lines(self, problem: Problem, state: WalkState) -> int:
        return self.counted.lines(problem, state)

    def arrivals(self, problem: Problem, state: WalkState) -> np.ndarray:
        return self.counted.arrivals(problem, state)

    def irradiance(self, problem: Problem, state: WalkState, group: int) -> tuple[np.ndarray, float]:
        values, unit = self.counted.irradiance(problem, state, group)
        return self._smoother(problem, state).smooth(values), unit

    def bias(self, problem: Problem, state: WalkState, group: int) -> np.ndarray:
        values, _ = self.counted.irradiance(problem, state, group)
        smoother = self._smoother(problem, state)
        return smoother.bias(values, smoother.smooth(values))

    def _smoother(self, problem: Problem, state: WalkState) -> Smoother:
        """Return the smoother of a state, the same for all bands and for the energy balance; the last one is kept."""
        if self._known.get("counts") is not state.arrivals:
            self._known.update(counts=state.arrivals, fit=Smoother.of(problem.patches, self.arrivals(problem, state)))
        return self._known["fit"]

    def books(self, problem: Problem, state: WalkState, group: int) -> dict:
        """Return the energy balance of the smoothed irradiance.

        It is not exact: smoothing moves power between patches of one region, whose reflectances may differ.
        """
        exact = self.counted.books(problem, state, group)
        values, unit = self.irradiance(problem, state, group)
        received = values.mean(axis=0) * unit
        absorbed = float(received @ (1 - problem.groups.scatter.albedo[:, group]))
        return by_difference(exact["emitted"], absorbed, exact["escaped"], exact["lost"])
