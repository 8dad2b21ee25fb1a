"""The tally of `Multipath`."""

import numpy as np

from ...problem.model import Problem
from ...solution.books import Books, by_difference
from ..base import AbstractTally
from . import first_shot
from .state import MultipathState

HIGHEST = 34  # bits of the largest power that a span can carry


def unit(problem: Problem, ends_per_line: np.ndarray, group: int) -> float:
    """Return the unit of powers in fixed point, W or lm.

    A span carries at most 2^HIGHEST of them: what the brightest patch emits at each end, over one less the largest reflectance.
    """
    groups = problem.groups
    brightest = float((groups.emission[:, group] * problem.patches.area / ends_per_line).max())
    return max(brightest, np.finfo(float).tiny) / (1 - float(groups.reflectance[:, group].max())) / 2.0**HIGHEST


class Landed(AbstractTally[MultipathState]):
    """Reads power that arrived along spans, and by a first shot where there was one."""

    def lines(self, problem: Problem, state: MultipathState) -> int:
        return int(state.ends.sum()) + first_shot.fired(state.shot)

    def arrivals(self, problem: Problem, state: MultipathState) -> np.ndarray:
        return state.ends.sum(axis=0) + first_shot.arrivals(state.shot)

    def irradiance(self, problem: Problem, state: MultipathState, group: int) -> tuple[np.ndarray, float]:
        watts = unit(problem, state.ends_per_line, group) / state.lines_done
        power = state.about("landed", group)
        if state.shot is None:
            return power, watts
        return power * watts + first_shot.landed(problem, state.shot, group)[0], 1.0

    def line(self, problem: Problem, state: MultipathState, group: int) -> np.ndarray | float:
        """Return the power that the brightest light sends along a span."""
        emitted = problem.groups.emission[:, group] * problem.patches.area / state.ends_per_line
        return float(emitted.max()) / max(state.lines_done, 1)

    def books(self, problem: Problem, state: MultipathState, group: int) -> dict:
        arrived, lines = state.exact("landed", group), state.lines_done
        replicates = len(state.landed[group])
        fired, reflected, escaped, lost = (
            sum((int(high) << 32) + int(low) for high, low in rows) for rows in state.ledger[group]
        )
        watts = unit(problem, state.ends_per_line, group) / lines / replicates
        emission = problem.groups.emission[:, group] * problem.patches.area
        if state.shot is not None:
            power, missed = first_shot.landed(problem, state.shot, group)
            rho = problem.groups.reflectance[:, group]
            absorbed = (arrived - reflected) * watts + float((power * (1 - rho)).sum()) / replicates
            escaped, lost = (x * watts + float(m.sum()) / replicates for x, m in zip((escaped, lost), missed, strict=True))
            return by_difference(float(emission.sum()), absorbed, escaped, lost)
        emitted = round(float(emission.sum()) / watts)
        return Books(
            emitted << 32,
            fired << 32,
            reflected << 32,
            (arrived - reflected) << 32,
            escaped << 32,
            lost << 32,
            watts / 2**32,
        ).powers()
