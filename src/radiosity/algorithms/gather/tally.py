"""Results of a gather, read from its sums."""

from dataclasses import dataclass

import numpy as np

from ...patches.bases import CONSTANT, Basis
from ...problem.model import Problem
from ...solution.books import by_difference, exact_sum
from ..base import AbstractBiasedTally
from .balance import factors
from .lines import UNITS, most_read
from .moments import units
from .near import Near
from .pilot import LINES
from .state import GatherState

ROUNDED = 2.0**-20  # of a value: less is lost in single precision
DIM = 2.0**-10  # of a value: where whole units of lines may take more, that counts, too


@dataclass(frozen=True)
class GatherTally(AbstractBiasedTally[GatherState]):
    """Reads means over the lines of each patch: what shadow rays bring, and what cosine lines meet.

    Attributes:
        near: light that few cosine lines find; None leaves it out.
        basis: of the light on patches.
    """

    counts_hits = False

    near: Near | None = None
    basis: Basis = CONSTANT

    def lines(self, problem: Problem, state: GatherState) -> int:
        return len(problem.patches) * LINES + (exact_sum(state.cosine) + exact_sum(state.rays)) * state.sizes.replicates

    def arrivals(self, problem: Problem, state: GatherState) -> np.ndarray:
        lines = state.cosine.astype(np.int64) + state.rays.astype(np.int64)
        return lines * state.sizes.replicates  # a patch is measured by the lines that leave it

    def parts(self, problem: Problem, state: GatherState, group: int) -> tuple[np.ndarray, np.ndarray, float]:
        """Return what shadow rays bring, and what cosine lines meet, (replicates, n_patches) each, and the unit of both.

        In each replicate all of it is multiplied so that the power of the scene balances, see `balance.factors`.
        """
        brought, met = self._measured(problem, state, group, 0)
        lines, unit = np.maximum(state.cosine, 1).astype(np.float64), float(problem.unit[group])
        if unit > 0 and problem.lights is None:  # what lights without area send past all patches is not known
            own = problem.groups.emission[:, group] * problem.patches.area / unit
            bias = self._bias_of_stored(problem, state, group)
            scatter, missed = problem.groups.scatter.column(group), state.missed.sum(axis=0)
            varies = self._variation(problem, state, group) if missed.any() else 0.0
            factor = factors(own, scatter, brought + met, missed, lines, bias, varies)
            brought, met = brought * factor, met * factor
        return brought, met, unit

    def _measured(self, problem: Problem, state: GatherState, group: int, function: int) -> tuple[np.ndarray, np.ndarray]:
        """Return moments of what shadow rays bring, and of what cosine lines meet, (replicates, n_patches) each."""
        column, unit, area = group * self.basis.size + function, UNITS * units(self.basis)[function], problem.patches.area
        rays, lines = (np.maximum(count, 1).astype(np.float64) for count in (state.rays, state.cosine))
        brought = state.about("brought", (..., column)) * (area / (rays * unit))
        return brought, state.about("met", (..., column)) * (area * most_read(problem) / (lines * unit))

    def _variation(self, problem: Problem, state: GatherState, group: int) -> np.ndarray:
        """Return the standard deviation of received power over the places of each patch, (n_patches,), less that of noise."""
        square = np.zeros(state.sizes.rows)
        for function in range(1, self.basis.size):
            brought, met = self._measured(problem, state, group, function)
            moment = np.ascontiguousarray(brought + met)  # sums depend on how arrays lie in memory
            noise = moment.var(axis=0, ddof=1) / len(moment) if len(moment) > 1 else 0.0
            square += np.maximum(moment.mean(axis=0) ** 2 - noise, 0.0)
        return np.sqrt(square)

    def irradiance(self, problem: Problem, state: GatherState, group: int) -> tuple[np.ndarray, float]:
        brought, met, unit = self.parts(problem, state, group)
        return brought + met, unit

    def moment(self, problem: Problem, state: GatherState, group: int, function: int) -> np.ndarray:
        measured, of_mean = (sum(self._measured(problem, state, group, one)) for one in (function, 0))
        balanced = self.irradiance(problem, state, group)[0]  # a polynomial keeps its shape
        return measured * np.divide(balanced, of_mean, out=np.ones_like(balanced), where=of_mean > 0)

    def line(self, problem: Problem, state: GatherState, group: int) -> np.ndarray | float:
        """Return the power that one of a patch's lines brings where it hits the brightest lamp."""
        return problem.unit[group] * problem.patches.area / np.maximum(state.cosine, 1)

    def _bias_of_stored(self, problem: Problem, state: GatherState, group: int, function: int = 0) -> np.ndarray:
        """Return the size of the bias of the solution along stored lines, (n_patches,), and of what iterations have left."""
        column = group * self.basis.size + function
        first, left = (np.abs(x[..., column].mean(axis=0, dtype=np.float64)) for x in (state.first_bias, state.bias_left))
        of_all = state.stored / np.maximum(state.cosine, 1)  # that of the solution by all lines goes as 1 / m
        return (np.maximum(left, first * of_all) + state.unsolved.mean()) * problem.patches.area

    def bias_of_sums(self, problem: Problem, state: GatherState, group: int) -> np.ndarray:
        value = self.irradiance(problem, state, group)[0].mean(axis=0)
        half = problem.patches.area * most_read(problem) / (2 * UNITS)  # of a unit of each cosine line: a dim line counts as none
        rounded = ROUNDED * value + np.where(half > DIM * value, half, 0.0)
        return self._bias_of_stored(problem, state, group) + rounded

    def bias(self, problem: Problem, state: GatherState, group: int) -> np.ndarray:
        bias = self.bias_of_sums(problem, state, group)
        if self.near is None:
            return bias
        unseen = self.near.unseen(state.cosine.astype(np.float64) * state.sizes.replicates)[:, group]
        return np.hypot(bias, np.sqrt(unseen) * problem.patches.area)

    def bias_of_moment(self, problem: Problem, state: GatherState, group: int, function: int) -> np.ndarray:
        bias, largest = self._bias_of_stored(problem, state, group, function), self.basis.largest[function]
        rest = self.bias(problem, state, group) - self._bias_of_stored(problem, state, group)  # of rounding, and unseen light
        return bias + largest * rest

    def books(self, problem: Problem, state: GatherState, group: int) -> dict:
        values, unit = self.irradiance(problem, state, group)
        return self.books_of(problem, state, group, values.mean(axis=0) * unit)

    def books_of(self, problem: Problem, state: GatherState, group: int, received: np.ndarray) -> dict:
        """Return the energy balance of the power that patches receive, (n_patches,) W or lm."""
        scatter, own = problem.groups.scatter.column(group), problem.groups.emission[:, group] * problem.patches.area
        left = own + scatter.of(received)
        escaped, lost = (float(left @ (count.mean(axis=0) / np.maximum(state.cosine, 1))) for count in state.missed)
        absorbed, emitted = float(received @ (1 - scatter.albedo)), float(own.sum())
        if problem.lights is not None:  # they emit what arrives: nothing counts what they send past all patches
            emitted = absorbed + escaped + lost
        return by_difference(emitted, absorbed, escaped, lost)
