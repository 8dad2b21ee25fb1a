"""States of the baselines that solve the equation."""

from dataclasses import dataclass

import numpy as np

from .merge_rules import added, of_first
from .state import AbstractState, Record, array, number, part


@dataclass(frozen=True, eq=False, kw_only=True)
class Solved(Record):
    """A solution, complete or so far.

    Attributes:
        done: True where more quanta would change nothing.
        lines: lines traced by all replicates.
        received: (replicates, n_patches, groups) float64, W or lm.
        missed: (replicates, 2, groups) float64, W or lm that escaped and was lost.
        seen: (n_patches,) the number of others that each patch exchanges light with, summed over replicates.
        history: (k, 2) steps, and the largest residual relative to the largest radiosity.
    """

    done: bool = number(bool)
    lines: int = number(int, merged=added)
    received: np.ndarray = array("replicates", "rows", "groups")
    missed: np.ndarray = array("replicates", 2, "groups")
    seen: np.ndarray = array("rows", merged=added)
    history: np.ndarray = array("any", 2, merged=of_first)


@dataclass(frozen=True, eq=False, kw_only=True)
class AbstractSolvedState(AbstractState):
    """The state of a baseline; ``solved`` is None before there is a solution."""

    solved: Solved | None = part(Solved, optional=True)


@dataclass(frozen=True, eq=False, kw_only=True)
class FullMatrixState(AbstractSolvedState):
    """The state of a full matrix, which is made whole or not at all."""

    @property
    def unfinished(self) -> bool:
        return self.solved is None
