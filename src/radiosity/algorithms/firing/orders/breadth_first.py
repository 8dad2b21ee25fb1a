"""Breadth-first: sweep after sweep, every row fires all it owes (Shirley 1991)."""

from ...process import Swept
from ..counters import FiringCounters
from .base import AbstractOrder
from .depth_first import walk_all

TAIL = 1 << 13  # fewer lines than this are followed to their ends at once: the counters are the same


class BreadthFirst(AbstractOrder):
    """Sweeps until no row owes a line."""

    def run(self, counters: FiringCounters, swept: Swept) -> None:
        while True:
            sweep, largest = counters.due()
            if sweep is None:
                return
            if sweep.total < TAIL and counters.bands is None:
                walk_all(counters, sweep, swept)
                return
            counters.fire(sweep, largest)
            swept(sweep.total)
            del sweep  # and the memory it holds
