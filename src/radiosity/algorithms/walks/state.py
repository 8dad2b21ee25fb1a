"""States of walks between two launches."""

from dataclasses import dataclass

import numpy as np

from ..merge_rules import fired_low, fired_upper
from ..state import AbstractState, array, number


@dataclass(frozen=True, eq=False, kw_only=True)
class AbstractLaunchState(AbstractState):
    """The state between two launches of a stage.

    Attributes:
        arrivals: (replicates, n_patches), hit counts, uint32 where that suffices, else uint64.
        missed: (2, replicates), lines that escaped and were lost, uint32 or uint64.
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
        fired_power: (groups,) uint64, power that left along lines of all replicates, modulo 2^64.
        received, received_missed: (replicates, n_patches, groups) and (2, replicates, groups) uint64, scores, modulo 2^64; where
            more than hits is kept.
        fired_power_upper, received_upper, received_missed_upper: upper words of these, where some are not zero.
        moments: (replicates, n_patches, groups, K - 1) int64, scores times the functions of a basis of K; only with such a basis.
    """

    fired_power: np.ndarray = array("groups", merged=fired_low)
    received: np.ndarray | None = array("replicates", "rows", "groups", optional=True)
    received_missed: np.ndarray | None = array(2, "replicates", "groups", optional=True)
    fired_power_upper: np.ndarray | None = array("groups", optional=True, merged=fired_upper, zeros=True)
    moments: np.ndarray | None = array("replicates", "rows", "groups", "any", optional=True)
    received_upper: np.ndarray | None = array("replicates", "rows", "groups", optional=True, zeros=True)
    received_missed_upper: np.ndarray | None = array(2, "replicates", "groups", optional=True, zeros=True)

    @property
    def fired_in_all(self) -> list[int]:
        """The power that left along lines, of each group."""
        above = np.zeros_like(self.fired_power) if self.fired_power_upper is None else self.fired_power_upper
        return [int(low) + (int(more) << 64) for low, more in zip(self.fired_power, above, strict=True)]


@dataclass(frozen=True, eq=False, kw_only=True)
class GatheringState(AbstractLaunchState):
    """Sums of walks that gather.

    Attributes:
        fired: (replicates, n_patches), lines that left each patch, uint32 where that suffices, else uint64.
        met: (replicates, n_patches, groups) uint64, the radiosity that they met, modulo 2^64; ``met_upper`` has the upper words.
    """

    fired: np.ndarray = array("replicates", "rows")
    met: np.ndarray = array("replicates", "rows", "groups")
    met_upper: np.ndarray | None = array("replicates", "rows", "groups", optional=True, zeros=True)
