"""Breadth-first order: in each wavefront, every row fires all lines that are due (Shirley 1991)."""

from ...base import Swept
from ..counters import FiringCounters
from ..due import due
from ..fire import fire
from .base import AbstractOrder
from .depth_first import more_is_due, walk_all

# Wavefronts of fewer lines are followed depth-first until they are absorbed: the counters are the same. A wavefront costs passes
# over all rows, and a kernel that Python traces anew; a depth-first launch adds single words. On a CPU, processor time is least
# from 2^15 to 2^18. For GPUs the number follows from rates of whole runs (docs/performance.md); it was not measured itself.
TAILS = {"cpu": 1 << 17, "cuda": 1 << 22}


def tail(counters: FiringCounters) -> int:
    """Return the number of lines below which a wavefront is followed depth-first; 0 with bands, which need whole wavefronts."""
    return TAILS[counters.tracer.geometry.device.name] if counters.bands is None else 0


class BreadthFirst(AbstractOrder):
    """Fires wavefronts until no line is due."""

    def run(self, counters: FiringCounters, swept: Swept) -> None:
        while True:
            wavefront, largest = due(counters)
            if wavefront is None:
                return
            if wavefront.blocks is None and wavefront.total < tail(counters):
                walk_all(counters, wavefront, swept)
                if not more_is_due(counters):
                    return
                continue
            before = counters.swept
            fire(counters, wavefront, largest)
            swept(counters.swept - before)  # of others, too, where they were fired elsewhere
            del wavefront  # frees its memory
