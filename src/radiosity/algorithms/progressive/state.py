"""The state of progressive refinement between two shots."""

from dataclasses import dataclass

import numpy as np

from ..alone import ALONE
from ..baseline_state import AbstractSolvedState
from ..state import array, number


@dataclass(frozen=True, eq=False, kw_only=True)
class ProgressiveState(AbstractSolvedState):
    """Power received and not shot yet.

    Attributes:
        shots: the number of shots so far.
        unshot: (n_patches, groups) float64, W/m² or lm/m².
        recent: (k,) int64, the patches whose rows are kept, the oldest first.
        cut_power: (groups,) W or lm that was cut off where form factors were larger than possible.
        cut: this power over the emitted power, of the worst group.
    """

    alone = ALONE["progressive"]

    shots: int = number(int)
    unshot: np.ndarray = array("rows", "groups")
    recent: np.ndarray = array("any")
    cut_power: np.ndarray = array("groups")
    cut: float = number(float)

    @property
    def unfinished(self) -> bool:
        return self.shots < self.quanta
