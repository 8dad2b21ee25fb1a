"""The tally of shooting walks."""

from dataclasses import dataclass

import numpy as np

from ...problem.model import Problem
from ...problem.quanta import Source
from ...solution.books import Books, by_difference, exact_sum, exact_totals
from ..base import AbstractTally
from .scores import UNIT
from .state import WalkState


@dataclass(frozen=True)
class WalkTally(AbstractTally[WalkState]):
    """Reads hits, or their scores.

    Attributes:
        collisions: True where every hit scores what it brings, so that the energy balance closes in whole numbers.
        chosen: True where a replicate has N walks, not a number rounded for each patch.
    """

    collisions: bool
    chosen: bool

    def lines(self, problem: Problem, state: WalkState) -> int:
        return exact_sum(state.arrivals) + exact_sum(state.missed)

    def arrivals(self, problem: Problem, state: WalkState) -> np.ndarray:
        return state.arrivals.sum(axis=0, dtype=np.int64)

    def irradiance(self, problem: Problem, state: WalkState, group: int) -> tuple[np.ndarray, float]:
        quantum = problem.source.power / state.quanta
        if state.received is not None:
            return state.received[..., group], quantum / UNIT
        return state.arrivals, quantum

    def books(self, problem: Problem, state: WalkState, group: int) -> dict:
        replicates, quanta = len(state.arrivals), state.quanta
        unit, counts, missed = 1, state.arrivals, state.missed
        if state.received is not None and state.received_missed is not None:
            unit, counts, missed = UNIT, state.received[..., group], state.received_missed[..., group]
        watts = problem.source.power / quanta / unit / 2**32 / replicates
        emission = float(problem.groups.emission[:, group] @ problem.patches.area)
        if not self.collisions:
            received = counts.sum(axis=0, dtype=np.float64)
            escaped, lost = (float(exact_sum(x)) * 2**32 * watts for x in missed)
            return by_difference(
                emission, float(received @ (1 - problem.groups.scatter.albedo[:, group])) * 2**32 * watts, escaped, lost
            )
        rho = Source.fixed_albedo(problem.groups.scatter, group)
        arrived, reflected = exact_totals(counts, rho)
        emitted = self._emitted(problem, quanta, unit, emission) * replicates
        fired = int(state.fired_power[group]) << 32
        escaped, lost = (exact_sum(x) << 32 for x in missed)
        return Books(emitted, fired, reflected, (arrived << 32) - reflected, escaped, lost, watts).powers()

    def _emitted(self, problem: Problem, quanta: int, unit: int, emission: float) -> int:
        if unit == 1 and not self.chosen:
            return problem.source.emitted_in_all(quanta)
        return round(emission / problem.source.power * quanta * unit) << 32
