"""States of global lines."""

from dataclasses import dataclass

import numpy as np

from ..alone import ALONE
from ..firing.state import FiringState
from ..merge_rules import alike
from ..state import AbstractState, array, number, part

HALVES = 2  # halves of a replicate of `Pooling`: each carries what the other has found


@dataclass(frozen=True, eq=False, kw_only=True)
class MultipathState(AbstractState):
    """Power that patches have not sent yet, and power that arrived.

    Attributes:
        lines_done: global lines of each replicate so far.
        ends: (replicates, n_patches) int64, span ends on each patch.
        ends_per_line: (n_patches,) float64, the expected number of ends for each line.
        ledger: (groups, 4, replicates, 2) uint64, sums of `exchange.LEDGER`, upper and lower 32 bits.
        unshot, landed: (groups, replicates, n_patches) uint64, in fixed point; ``landed`` is modulo 2^64.
        landed_upper: uint32, the upper words of ``landed``, where some are not zero.
        shot: the lines of the first shot, where there is one.
    """

    lines_done: int = number(int)
    ends: np.ndarray = array("replicates", "rows")
    ends_per_line: np.ndarray = array("rows", merged=alike)
    ledger: np.ndarray = array("groups", 4, "replicates", 2)
    unshot: np.ndarray = array("groups", "replicates", "rows")
    landed: np.ndarray = array("groups", "replicates", "rows")
    landed_upper: np.ndarray | None = array("groups", "replicates", "rows", optional=True, zeros=True)
    shot: FiringState | None = part(FiringState, "shot_", optional=True)

    @property
    def unfinished(self) -> bool:
        return self.lines_done < self.quanta


@dataclass(frozen=True, eq=False, kw_only=True)
class PoolingState(AbstractState):
    """Sums of iterations, one half of a replicate after the other; see `Pooling`.

    Attributes:
        lines_done: global lines of each half so far.
        replicates: the number of independent runs.
        shot: the lines of the first shot, where there is one.
    """

    alone = ALONE["pooling"]

    carried: np.ndarray = array("groups", "rows of halves")
    recent: np.ndarray = array("groups", "rows of halves")
    recent_ends: np.ndarray = array("rows of halves")
    fresh: np.ndarray = array("groups", "rows of halves")
    fresh_ends: np.ndarray = array("rows of halves")
    received: np.ndarray = array("groups", "rows of halves")
    ends: np.ndarray = array("rows of halves")
    escaped: np.ndarray = array("rows of halves")
    lost: np.ndarray = array("rows of halves")
    lines_done: int = number(int)
    replicates: int = number(int)
    shot: FiringState | None = part(FiringState, "shot_", optional=True)

    @property
    def unfinished(self) -> bool:
        return self.lines_done < lines_of_half(self.quanta)


def lines_of_half(quanta: int) -> int:
    """Return the number of lines of each half of a replicate."""
    return -(-quanta // HALVES)
