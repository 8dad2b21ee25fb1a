"""The tally of the matrix method: form factors from counted lines, and the solution of the equation with them."""

import numpy as np

from ...factors.counted import CountedPairs, Received
from ...problem.model import Problem
from ...solution.books import by_difference
from ...tally.unmet import bias
from ..base import AbstractMeanTally
from .state import MatrixState


class MatrixTally(AbstractMeanTally[MatrixState]):
    """Solves with counted pairs; the last state's results are kept, since they are asked for more than once.

    Attributes:
        both_ways, directed: see `CountedPairs`.
        pairs: those of the state, where they have been made.
    """

    def __init__(self, both_ways: bool, *, directed: bool = False, pairs: CountedPairs | None = None):
        self.both_ways, self.directed = both_ways, directed
        self._pairs = pairs
        self._solved: list[Received] = []

    def pairs(self, problem: Problem, state: MatrixState) -> CountedPairs:
        """Return the counted pairs of a state, which depend on geometry alone."""
        if self._pairs is None or self._pairs.keys is not state.keys:
            self._solved = []
            self._pairs = CountedPairs(problem.patches, state.keys, state.counts, state.replicates, self.both_ways, self.directed)
        return self._pairs

    def lines(self, problem: Problem, state: MatrixState) -> int:
        """Return the number of lines: a line of a patch is one entry, a span between two patches is two."""
        return int(state.counts.sum(dtype=np.uint64))

    def arrivals(self, problem: Problem, state: MatrixState) -> np.ndarray:
        return self.pairs(problem, state).arrivals

    def irradiance(self, problem: Problem, state: MatrixState, group: int) -> tuple[np.ndarray, float]:
        return self._received(problem, state, group).power, 1.0

    def bias(self, problem: Problem, state: MatrixState, group: int) -> np.ndarray:
        """Return the bias: what patches without lines were given, and what patches get back of their own light.

        For the second see `solve.of_own_light`.
        """
        found = self._received(problem, state, group)
        return bias(found.power, self.measured(problem, state)) + found.bias.mean(axis=0)

    def measured(self, problem: Problem, state: MatrixState) -> np.ndarray:
        return self.pairs(problem, state).lines

    def line(self, problem: Problem, state: MatrixState, group: int) -> np.ndarray | float:
        """Return the power that one of a patch's lines brings where it hits the brightest light."""
        each = self.pairs(problem, state).lines.mean(axis=0)
        return problem.groups.emission[:, group].max() * problem.patches.area / np.maximum(each, 1)

    def books(self, problem: Problem, state: MatrixState, group: int) -> dict:
        found = self._received(problem, state, group)
        emitted = float(problem.groups.emission[:, group] @ problem.patches.area)
        absorbed = float(found.power.mean(axis=0) @ (1 - problem.groups.scatter.albedo[:, group]))
        return by_difference(emitted, absorbed, *(float(x) for x in found.missed.mean(axis=0)))

    def _received(self, problem: Problem, state: MatrixState, group: int) -> Received:
        pairs = self.pairs(problem, state)
        if not self._solved:
            self._solved = pairs.solve(problem.groups.emission, problem.groups.scatter)
        return self._solved[group]
