"""What the state of iterations means."""

import numpy as np

from ...problem.model import Problem
from ...problem.quanta import Source
from ...solution.books import Books, by_difference, exact_sum, exact_totals
from ..base import AbstractTally, State
from .control import kept
from .exchange import LINE


class IterationTally(AbstractTally):
    """Power received, in fixed point; ``scale`` times it is the share of Phi. Then what a control variate put aside."""

    def lines(self, problem: Problem, state: State) -> int:
        return int(state["fired"].sum(dtype=np.uint64))

    def arrivals(self, problem: Problem, state: State) -> np.ndarray:
        return state["arrivals"].sum(axis=0, dtype=np.int64)

    def irradiance(self, problem: Problem, state: State, group: int) -> tuple[np.ndarray, float]:
        values, _ = _received(problem, state, group)
        return values, problem.source.power

    def line(self, problem: Problem, state: State, group: int) -> np.ndarray | float:
        """Of the lines traced, of which few-lined stages have more than quanta."""
        return super().line(problem, state | {"quanta": np.asarray(self.lines(problem, state) // len(state["fired"]))}, group)

    def books(self, problem: Problem, state: State, group: int) -> dict:
        if "left" in state:
            return _exact(problem, state, group)
        values, missed = _received(problem, state, group)
        power, area = problem.source.power, problem.patches.area
        absorbed = float((values.mean(axis=0) * power) @ (1 - problem.groups.reflectance[:, group]))
        escaped, lost = (float(x) * power for x in missed.mean(axis=1))
        return by_difference(float(problem.groups.emission[:, group] @ area), absorbed, escaped, lost)


def _received(problem: Problem, state: State, group: int) -> tuple[np.ndarray, np.ndarray]:
    """Shares of Phi: received by patches, (replicates, n_patches), and escaped and lost, (2, replicates)."""
    replicates, n = state["fired"].shape
    received = state["received"].reshape(replicates * (n + 2), -1)[:, group] * float(state["scale"])
    values, missed = received[: replicates * n].reshape(replicates, n), received[replicates * n :].reshape(2, replicates)
    if "probed" in state:
        beta = state.get("constants", state["beta"])[:, group, None]
        area = problem.patches.area / problem.patches.area.sum()
        values = values + beta * area * kept(state["probe_missed"], state["probed"])
        shares = state["probe_missed"] / np.maximum(state["probed"], 1)
        missed = missed + beta[:, 0] * (shares @ area)
    return values, missed


def _exact(problem: Problem, state: State, group: int) -> dict:
    """Of incremental iterations in one direction, power is carried line by line, in whole numbers."""
    replicates, n = state["fired"].shape
    received = state["received"].reshape(replicates * (n + 2), -1)[:, group].astype(np.uint64)
    counts, missed = received[: replicates * n].reshape(replicates, n), received[replicates * n :].reshape(2, replicates)
    rho = Source.fixed(problem.groups.reflectance[:, group])
    arrived, reflected = exact_totals(counts, rho)
    emitted, fired = (exact_sum(state[key][:, group].astype(np.uint64)) << 32 for key in ("emitted", "left"))
    watts = problem.source.power / int(state["quanta"]) / LINE / 2**32 / replicates
    escaped, lost = (exact_sum(row) << 32 for row in missed)
    return Books(emitted, fired, reflected, (arrived << 32) - reflected, escaped, lost, watts).powers()
