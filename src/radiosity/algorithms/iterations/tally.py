"""The tally of iterations."""

from dataclasses import dataclass

import numpy as np

from ...patches.bases import CONSTANT, Basis
from ...problem.model import Problem
from ...problem.quanta import Source
from ...solution.books import Books, by_difference, exact_sum, exact_totals
from ..base import AbstractTally, line_of_quanta
from .control import moments_kept
from .exchange import units_of_a_quantum
from .state import IncrementalState, IterationState


@dataclass(frozen=True)
class IterationTally(AbstractTally[IterationState]):
    """Reads power received, in fixed point, where ``scale`` times it is the share of Phi, and adds that of a control variate.

    Attributes:
        basis: of the light on patches.
    """

    basis: Basis = CONSTANT

    def lines(self, problem: Problem, state: IterationState) -> int:
        return exact_sum(state.fired)

    def arrivals(self, problem: Problem, state: IterationState) -> np.ndarray:
        return state.arrivals[:, : len(problem.patches)].sum(axis=0, dtype=np.int64)

    def irradiance(self, problem: Problem, state: IterationState, group: int) -> tuple[np.ndarray, float]:
        values, _ = _received(problem, state, group, self.basis.size)
        return values, problem.source.power

    def moment(self, problem: Problem, state: IterationState, group: int, function: int) -> np.ndarray:
        return _received(problem, state, group, self.basis.size, function)[0]

    def line(self, problem: Problem, state: IterationState, group: int) -> np.ndarray | float:
        """Return the power of a line from the number of lines traced, which in short stages is larger than that of quanta.

        Where lines are shared out by importance, it is that of a line from a patch as important as the one that it hits.
        """
        if state.importance is not None:
            return line_of_quanta(problem, state.quanta, group) / state.importance[: len(problem.patches)]
        return line_of_quanta(problem, self.lines(problem, state) // len(state.fired), group)

    def books(self, problem: Problem, state: IterationState, group: int) -> dict:
        if isinstance(state.scheme, IncrementalState) and state.scheme.left is not None:
            return _exact(problem, state, state.scheme, group)
        values, missed = _received(problem, state, group, self.basis.size)
        power, rows = problem.source.power, problem.rows
        absorbed = float((values.mean(axis=0) * power) @ (1 - problem.groups.scatter.albedo[:, group]))
        escaped, lost = (float(x) * power for x in missed.mean(axis=1))
        return by_difference(float(rows.emission[:, group] @ rows.area), absorbed, escaped, lost)


def _received(problem: Problem, state: IterationState, group: int, size: int, function: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return shares of Phi: received by patches, (replicates, n_patches), and escaped and lost, (2, replicates).

    Args:
        size: the number of functions of the basis.
        function: whose moment of the power is returned; that of the first is the power itself.
    """
    replicates, n = state.fired.shape
    scheme, control = state.scheme, state.control
    received = scheme.received.reshape(replicates * (n + 2), -1)[:, group * size + function] * scheme.scale
    values, missed = received[: replicates * n].reshape(replicates, n), received[replicates * n :].reshape(2, replicates)
    values = values[:, : len(problem.patches)]  # lights without area receive nothing
    if control is not None:
        beta = (control.beta if isinstance(scheme, IncrementalState) else scheme.constants)[:, group * size, None]
        area = problem.patches.area / problem.patches.area.sum()
        kept = moments_kept(control.probe_missed, control.probe_moments, control.probed)
        values = values + beta * area * kept[..., function]
        shares = control.probe_missed / np.maximum(control.probed, 1)
        missed = missed + beta[:, 0] * (shares @ area)
    return values, missed


def _exact(problem: Problem, state: IterationState, scheme: IncrementalState, group: int) -> dict:
    """Return the energy balance of incremental iterations in one direction, which carry power in whole numbers, by lines."""
    replicates, n = state.fired.shape
    received = scheme.received.reshape(replicates * (n + 2), -1)[:, group].astype(np.uint64)
    counts, missed = received[: replicates * n].reshape(replicates, n), received[replicates * n :].reshape(2, replicates)
    rho = Source.fixed_albedo(problem.rows.scatter, group)
    arrived, reflected = exact_totals(counts, rho)
    assert scheme.emitted is not None
    assert scheme.left is not None
    emitted, fired = (exact_sum(power[:, group].astype(np.uint64)) << 32 for power in (scheme.emitted, scheme.left))
    watts = problem.source.power / state.quanta / units_of_a_quantum(state.importance) / 2**32 / replicates
    escaped, lost = (exact_sum(row) << 32 for row in missed)
    return Books(emitted, fired, reflected, (arrived << 32) - reflected, escaped, lost, watts).powers()
