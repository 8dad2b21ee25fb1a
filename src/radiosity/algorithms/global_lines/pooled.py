"""The tally of `Pooling`."""

import numpy as np

from ...problem.model import Problem
from ...solution.books import by_difference
from ...tally.unmet import bias, means, sides
from ..base import AbstractMeanTally
from . import first_shot
from .state import PoolingState

UNIT = 2.0**-34  # share of a group's largest emission that radiosity is rounded to, so that its sums are whole numbers


def units(problem: Problem) -> np.ndarray:
    """Return the unit of radiosity of each group, (n_groups,) W/m²."""
    return problem.groups.emission.max(axis=0) * UNIT


class Pooled(AbstractMeanTally[PoolingState]):
    """Reads means over span ends, and a first shot where there was one."""

    def lines(self, problem: Problem, state: PoolingState) -> int:
        return int(state.ends.sum()) + first_shot.fired(state.shot)

    def arrivals(self, problem: Problem, state: PoolingState) -> np.ndarray:
        return _pooled(problem, state.ends, state).sum(axis=0) + first_shot.arrivals(state.shot)

    def irradiance(self, problem: Problem, state: PoolingState, group: int) -> tuple[np.ndarray, float]:
        power = self._pooled(problem, state, group)
        if state.shot is not None:
            power = power + first_shot.landed(problem, state.shot, group)[0]
        return power, 1.0

    def _pooled(self, problem: Problem, state: PoolingState, group: int) -> np.ndarray:
        """Return the power without that of a first shot, (replicates, n_patches) W or lm."""
        received, ends = _pooled(problem, state.received[group], state), self.measured(problem, state)
        return means(received, ends, sides(problem.patches)) * (problem.patches.area * units(problem)[group])

    def bias(self, problem: Problem, state: PoolingState, group: int) -> np.ndarray:
        return bias(self._pooled(problem, state, group), self.measured(problem, state))

    def measured(self, problem: Problem, state: PoolingState) -> np.ndarray:
        return _pooled(problem, state.ends, state)

    def line(self, problem: Problem, state: PoolingState, group: int) -> np.ndarray | float:
        """Return the power that one of a patch's ends brings where it sees the brightest light."""
        ends = self.measured(problem, state)
        return problem.groups.emission[:, group].max() * problem.patches.area / np.maximum(ends.mean(axis=0), 1)

    def books(self, problem: Problem, state: PoolingState, group: int) -> dict:
        """Return the energy balance.

        Of what a patch sends, the share of its ends that see nothing escaped, and the share that see an absorbing back was lost.
        """
        power, _ = self.irradiance(problem, state, group)
        rho, replicates = problem.groups.reflectance[:, group], len(power)
        emission = problem.groups.emission[:, group] * problem.patches.area
        sent, missed = rho * power + emission, np.zeros((2, replicates))
        if state.shot is not None:
            sent, missed = rho * power, first_shot.landed(problem, state.shot, group)[1]
        ends = np.maximum(_pooled(problem, state.ends, state), 1)
        escaped, lost = (
            float((sent * _pooled(problem, values, state) / ends).sum() + more.sum()) / replicates
            for values, more in zip((state.escaped, state.lost), missed, strict=True)
        )
        return by_difference(float(emission.sum()), float(((1 - rho) * power).sum()) / replicates, escaped, lost)


def _pooled(problem: Problem, values: np.ndarray, state: PoolingState) -> np.ndarray:
    """Return the sums over the halves of each replicate, (replicates, n_patches)."""
    return values.reshape(state.replicates, -1, len(problem.patches)).sum(axis=1)
