"""Breadth-first order: in each wavefront, every row fires all lines that are due (Shirley 1991)."""

from ...base import Swept
from ..counters import FiringCounters
from .base import AbstractOrder
from .depth_first import walk_all

TAIL = 1 << 13  # wavefronts of fewer lines are followed depth-first until they are absorbed: the counters are the same


class BreadthFirst(AbstractOrder):
    """Fires wavefronts until no line is due."""

    def run(self, counters: FiringCounters, swept: Swept) -> None:
        while True:
            wavefront, largest = counters.due()
            if wavefront is None:
                return
            if wavefront.total < TAIL and counters.bands is None:
                walk_all(counters, wavefront, swept)
                return
            counters.fire(wavefront, largest)
            swept(wavefront.total)
            del wavefront  # frees its memory
