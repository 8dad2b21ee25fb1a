"""The tally of shooting walks."""

from dataclasses import dataclass

import numpy as np

from ...patches.bases import CONSTANT, Basis
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
        basis: of the light on patches.
    """

    collisions: bool
    chosen: bool
    basis: Basis = CONSTANT

    def lines(self, problem: Problem, state: WalkState) -> int:
        return exact_sum(state.arrivals) + exact_sum(state.missed)

    def arrivals(self, problem: Problem, state: WalkState) -> np.ndarray:
        return state.arrivals.sum(axis=0, dtype=np.int64)

    def irradiance(self, problem: Problem, state: WalkState, group: int) -> tuple[np.ndarray, float]:
        quantum = problem.source.power / state.quanta
        if state.received is not None:
            return state.about("received", (..., group)), quantum / UNIT
        return state.arrivals, quantum

    def moment(self, problem: Problem, state: WalkState, group: int, function: int) -> np.ndarray:
        assert state.moments is not None
        unit = 1.0 if state.received is not None else 1.0 / UNIT  # that of the hits or of the scores
        return state.moments[..., group, function - 1] * unit

    def books(self, problem: Problem, state: WalkState, group: int) -> dict:
        replicates, quanta = len(state.arrivals), state.quanta
        unit = 1 if state.received is None else UNIT
        if state.received is None:
            missed = [exact_sum(kind) for kind in state.missed]
        else:
            missed = [state.exact("received_missed", (kind, slice(None), group)) for kind in range(2)]
        watts = problem.source.power / quanta / unit / 2**32 / replicates
        emission = float(problem.groups.emission[:, group] @ problem.patches.area)
        if not self.collisions:
            counts = state.arrivals if state.received is None else state.about("received", (..., group))
            received = counts.sum(axis=0, dtype=np.float64)
            escaped, lost = (float(x) * 2**32 * watts for x in missed)
            return by_difference(
                emission, float(received @ (1 - problem.groups.scatter.albedo[:, group])) * 2**32 * watts, escaped, lost
            )
        rho = Source.fixed_albedo(problem.groups.scatter, group)
        arrived, reflected = exact_totals(state.arrivals, rho) if unit == 1 else state.totals("received", (..., group), rho)
        emitted = self._emitted(problem, quanta, unit, emission) * replicates
        fired = state.fired_in_all[group] << 32
        escaped, lost = (x << 32 for x in missed)
        return Books(emitted, fired, reflected, (arrived << 32) - reflected, escaped, lost, watts).powers()

    def _emitted(self, problem: Problem, quanta: int, unit: int, emission: float) -> int:
        if unit == 1 and not self.chosen:
            return problem.source.emitted_in_all(quanta)
        return round(emission / problem.source.power * quanta * unit) << 32
