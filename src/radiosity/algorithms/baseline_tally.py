"""The tally of baselines: it reads the powers that they found, and the residual."""

import numpy as np

from ..problem.model import Problem
from ..solution.books import by_difference
from .base import AbstractTally
from .baseline_state import AbstractSolvedState, Solved


class SolvedTally(AbstractTally[AbstractSolvedState]):
    """Reads `Solved`."""

    counts_hits = False

    def lines(self, problem: Problem, state: AbstractSolvedState) -> int:
        return _of(state).lines

    def arrivals(self, problem: Problem, state: AbstractSolvedState) -> np.ndarray:
        return _of(state).seen.astype(np.int64)

    def irradiance(self, problem: Problem, state: AbstractSolvedState, group: int) -> tuple[np.ndarray, float]:
        return _of(state).received[..., group], 1.0

    def books(self, problem: Problem, state: AbstractSolvedState, group: int) -> dict:
        emitted = float(problem.groups.emission[:, group] @ problem.patches.area)
        received = _of(state).received[..., group].mean(axis=0)
        absorbed = float(received @ (1 - problem.groups.scatter.albedo[:, group]))
        escaped, lost = _of(state).missed[..., group].mean(axis=0)
        return by_difference(emitted, absorbed, float(escaped), float(lost))


def _of(state: AbstractSolvedState) -> Solved:
    assert state.solved is not None
    return state.solved
