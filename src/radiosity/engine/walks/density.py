"""Landings of particles, reconstructed by local linear fits."""

from dataclasses import dataclass

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

    def lines(self, problem: Problem, state: State) -> int:
        return self.counted.lines(problem, state)

    def arrivals(self, problem: Problem, state: State) -> np.ndarray:
        return self.counted.arrivals(problem, state)

    def irradiance(self, problem: Problem, state: State, group: int) -> tuple[np.ndarray, float]:
        values, unit = self.counted.irradiance(problem, state, group)
        patches = problem.patches
        regions = Regions.find(patches)
        smooth = weights(regions, self.arrivals(problem, state), patches.centroid, regions.of)
        return np.stack([smooth @ (row / patches.area) * patches.area for row in values]), unit

    def books(self, problem: Problem, state: State, group: int) -> dict:
        """Of the smoothed irradiance: what smoothing moved from one patch to another does not balance exactly."""
        exact = self.counted.books(problem, state, group)
        values, unit = self.irradiance(problem, state, group)
        received = values.mean(axis=0) * unit
        absorbed = float(received @ (1 - problem.groups.reflectance[:, group]))
        return by_difference(exact["emitted"], absorbed, exact["escaped"], exact["lost"])
