"""Results of a gather, smoothed over each plane."""

from dataclasses import dataclass, field

import numpy as np

from ...problem.model import Problem
from ...solution.binomial import smoothed
from ..base import AbstractBiasedTally
from .state import GatherState
from .tally import GatherTally


@dataclass(frozen=True)
class SmoothTally(AbstractBiasedTally[GatherState]):
    """Smooths the values of another tally: what lamps bring, whose shadows have sharp edges, and the rest, each by itself.

    Attributes:
        plain: the tally that reads the sums.
    """

    counts_hits = False

    plain: GatherTally
    _known: dict = field(default_factory=dict, compare=False)

    def lines(self, problem: Problem, state: GatherState) -> int:
        return self.plain.lines(problem, state)

    def arrivals(self, problem: Problem, state: GatherState) -> np.ndarray:
        return self.plain.arrivals(problem, state)

    def irradiance(self, problem: Problem, state: GatherState, group: int) -> tuple[np.ndarray, float]:
        values, _, unit = self._smoothed(problem, state, group)
        return values, unit

    def line(self, problem: Problem, state: GatherState, group: int) -> np.ndarray | float:
        return self.plain.line(problem, state, group)

    def bias(self, problem: Problem, state: GatherState, group: int) -> np.ndarray:
        _, bias, _ = self._smoothed(problem, state, group)
        return bias + self.plain.bias(problem, state, group)

    def bias_of_sums(self, problem: Problem, state: GatherState, group: int) -> np.ndarray:
        """Return the bias without that of smoothing, which keeps the sums of surfaces."""
        return self.plain.bias_of_sums(problem, state, group)

    def books(self, problem: Problem, state: GatherState, group: int) -> dict:
        values, unit = self.irradiance(problem, state, group)
        return self.plain.books_of(problem, state, group, values.mean(axis=0) * unit)

    def _smoothed(self, problem: Problem, state: GatherState, group: int) -> tuple[np.ndarray, np.ndarray, float]:
        """Return values, (replicates, n_patches), the bias of smoothing, (n_patches,), and the unit, kept for each state."""
        if self._known.get("state") is not state:
            self._known.clear()
            self._known["state"] = state
        if group not in self._known:
            *both, unit = self.plain.parts(problem, state, group)
            parts = [smoothed(problem.patches, part) for part in both]
            self._known[group] = sum(part for part, _ in parts), sum(bias for _, bias in parts), unit
        return self._known[group]
