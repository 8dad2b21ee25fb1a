"""Landings of particles, reconstructed by local linear fits."""

from dataclasses import dataclass, field

import numpy as np

from ...problem.model import Problem
from ...solution.books import by_difference
from ...solution.smoothing import Smoother
from ..base import AbstractBiasedTally, AbstractTally
from .state import WalkState


@dataclass(frozen=True)
class DensityTally(AbstractBiasedTally[WalkState]):
    """Another tally's powers, smoothed replicate by replicate with the bandwidths of all landings together.

    Attributes:
        counted: how the landings are read.
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
        """The same for all bands and for the books of a state; the last one is kept."""
        if self._known.get("counts") is not state.arrivals:
            self._known.update(counts=state.arrivals, fit=Smoother.of(problem.patches, self.arrivals(problem, state)))
        return self._known["fit"]

    def books(self, problem: Problem, state: WalkState, group: int) -> dict:
        """Of the smoothed irradiance: what smoothing moved between patches of one region, where their reflectances differ, does
        not balance exactly."""
        exact = self.counted.books(problem, state, group)
        values, unit = self.irradiance(problem, state, group)
        received = values.mean(axis=0) * unit
        absorbed = float(received @ (1 - problem.groups.reflectance[:, group]))
        return by_difference(exact["emitted"], absorbed, exact["escaped"], exact["lost"])
