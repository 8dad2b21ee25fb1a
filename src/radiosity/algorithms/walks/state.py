"""States of walks between two launches."""

from dataclasses import dataclass

import numpy as np

from ..merge_rules import added
from ..state import AbstractState, array, number


@dataclass(frozen=True, eq=False, kw_only=True)
class AbstractLaunchState(AbstractState):
    """The state between two launches of a stage.

    Attributes:
        arrivals: (replicates, n_patches) uint32, hit counts.
        missed: (2, replicates) uint32, lines that escaped and were lost.
        quanta_before, launches: within a stage, N of the stage before, and the number of chunks done (`lanes.chunk`).
    """

    arrivals: np.ndarray = array("replicates", "rows")
    missed: np.ndarray = array(2, "replicates")
    quanta_before: int | None = number(int, optional=True)
    launches: int | None = number(int, optional=True)

    @property
    def unfinished(self) -> bool:
        return self.launches is not None


@dataclass(frozen=True, eq=False, kw_only=True)
class WalkState(AbstractLaunchState):
    """Sums of walks that shoot.

    Attributes:
        fired_power: (groups,) uint64, power that left along lines of all replicates.
        received, received_missed: (replicates, n_patches, groups) and (2, replicates, groups) uint64, scores; where more
            than hits is kept.
    """

    fired_power: np.ndarray = array("groups", merged=added)
    received: np.ndarray | None = array("replicates", "rows", "groups", optional=True)
    received_missed: np.ndarray | None = array(2, "replicates", "groups", optional=True)


@dataclass(frozen=True, eq=False, kw_only=True)
class GatheringState(AbstractLaunchState):
    """Sums of walks that gather.

    Attributes:
        fired: (replicates, n_patches) uint32, lines that left each patch.
        met: (replicates, n_patches, groups) uint64, the radiosity that they met.
    """

    fired: np.ndarray = array("replicates", "rows")
    met: np.ndarray = array("replicates", "rows", "groups")
