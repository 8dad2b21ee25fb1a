"""How the state of a `Pooling` is read."""

import numpy as np

from ...problem.model import Problem
from ...solution.books import by_difference
from ...tally.unmet import bias, means, sides
from ..base import AbstractMeanTally
from . import first_shot
from .state import PoolingState

UNIT = 2.0**-34  # of a group's largest emission: what radiosity is rounded to, so that its sums are whole numbers


def units(problem: Problem) -> np.ndarray:
    """(n_groups,) W/m²: what radiosity is counted in."""
    return problem.groups.emission.max(axis=0) * UNIT


class Pooled(AbstractMeanTally[PoolingState]):
    """Means over span ends, after a first shot where there was one."""

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
        """(replicates, n_patches) W or lm, without what a first shot brought."""
        received, ends = _pooled(problem, state.received[group], state), self.measured(problem, state)
        return means(received, ends, sides(problem.patches)) * (problem.patches.area * units(problem)[group])

    def bias(self, problem: Problem, state: PoolingState, group: int) -> np.ndarray:
        return bias(self._pooled(problem, state, group), self.measured(problem, state))

    def measured(self, problem: Problem, state: PoolingState) -> np.ndarray:
        return _pooled(problem, state.ends, state)

    def line(self, problem: Problem, state: PoolingState, group: int) -> np.ndarray | float:
        """Of a patch's ends one sees the brightest light."""
        ends = self.measured(problem, state)
        return problem.groups.emission[:, group].max() * problem.patches.area / np.maximum(ends.mean(axis=0), 1)

    def books(self, problem: Problem, state: PoolingState, group: int) -> dict:
        """Escaped or lost is, of what a patch sends, the share of its ends that see nothing, or an absorbing back."""
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
    """(replicates, n_patches): sums of the halves of each replicate."""
    return values.reshape(state.replicates, -1, len(problem.patches)).sum(axis=1)
