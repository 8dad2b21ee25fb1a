"""Landings of particles, reconstructed by local linear fits."""

from dataclasses import dataclass, field

import numpy as np

from ...solution.books import by_difference
from ...solution.local_linear import Regions, weights
from ..problem import Problem
from ..process import AbstractTally, State


@dataclass(frozen=True)
class DensityTally(AbstractTally):
    """Another tally's powers, smoothed replicate by replicate with the bandwidths of all landings together.

    Attributes:
        counted: how the landings are read.
    """

    counted: AbstractTally
    _known: dict = field(default_factory=dict, compare=False)

    def lines(self, problem: Problem, state: State) -> int:
        return self.counted.lines(problem, state)

    def arrivals(self, problem: Problem, state: State) -> np.ndarray:
        return self.counted.arrivals(problem, state)

    def irradiance(self, problem: Problem, state: State, group: int) -> tuple[np.ndarray, float]:
        values, unit = self.counted.irradiance(problem, state, group)
        patches, smooth = problem.patches, self._smoother(problem, state)
        return np.stack([smooth @ (row / patches.area) * patches.area for row in values]), unit

    def _smoother(self, problem: Problem, state: State):
        """The same for all bands and for the books of a state; the last one is kept."""
        if self._known.get("counts") is not state["arrivals"]:
            regions = Regions.find(problem.patches)
            fit = weights(regions, self.arrivals(problem, state), problem.patches.centroid, regions.of)
            self._known.update(counts=state["arrivals"], fit=fit)
        return self._known["fit"]

    def books(self, problem: Problem, state: State, group: int) -> dict:
        """Of the smoothed irradiance: what smoothing moved from one patch to another does not balance exactly."""
        exact = self.counted.books(problem, state, group)
        values, unit = self.irradiance(problem, state, group)
        received = values.mean(axis=0) * unit
        absorbed = float(received @ (1 - problem.groups.reflectance[:, group]))
        return by_difference(exact["emitted"], absorbed, exact["escaped"], exact["lost"])
