"""Breadth-first: sweep after sweep, every row fires all it owes (Shirley 1991)."""

from ...base import Swept
from ..counters import FiringCounters
from .base import AbstractOrder
from .depth_first import walk_all

TAIL = 1 << 13  # fewer lines than this are followed to their ends at once: the counters are the same


class BreadthFirst(AbstractOrder):
    """Sweeps until no row owes a line."""

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
            del wavefront  # and the memory it holds
