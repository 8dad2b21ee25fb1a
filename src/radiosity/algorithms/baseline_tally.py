"""How the state of a baseline is read: powers that it found, and what it left over."""

import numpy as np

from ..problem.model import Problem
from ..solution.books import by_difference
from .base import AbstractTally, State


class SolvedTally(AbstractTally):
    """Keys of a state: quanta; done; lines (one number); received (replicates, n_patches, groups), W; missed (replicates, 2,
    groups), W that escaped and was lost; seen (n_patches,), how many of others each patch exchanges light with; history (k, 2):
    steps, and the largest residual relative to the largest radiosity."""

    counts_hits = False

    def lines(self, problem: Problem, state: State) -> int:
        return int(state["lines"])

    def arrivals(self, problem: Problem, state: State) -> np.ndarray:
        return state["seen"].astype(np.int64)

    def irradiance(self, problem: Problem, state: State, group: int) -> tuple[np.ndarray, float]:
        return state["received"][..., group], 1.0

    def books(self, problem: Problem, state: State, group: int) -> dict:
        emitted = float(problem.groups.emission[:, group] @ problem.patches.area)
        received = state["received"][..., group].mean(axis=0)
        absorbed = float(received @ (1 - problem.groups.reflectance[:, group]))
        escaped, lost = state["missed"][..., group].mean(axis=0)
        return by_difference(emitted, absorbed, float(escaped), float(lost))
