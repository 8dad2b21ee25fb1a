"""Well-distributed order: rows fire one after the other, by their numbers (WDRS, Neumann, Neumann and Bekaert 1997).

Each row fires the lines that it lacks for its share of power. A block of rows fires at a time. Light that hits a later block
leaves in the same pass, light that hits an earlier one in the next pass. The set of lines is the same as in any other order.
"""

from ...base import Swept
from ..counters import FiringCounters
from ..due import due_between
from ..fire import fire
from .base import AbstractOrder
from .breadth_first import BreadthFirst, tail

BLOCKS = 8


class WellDistributed(AbstractOrder):
    """Passes over the blocks until no line is due."""

    def run(self, counters: FiringCounters, swept: Swept) -> None:
        if counters.bands is not None or counters.total < BLOCKS:
            BreadthFirst().run(counters, swept)
            return
        while self._due(counters) >= max(tail(counters), 1):
            self._pass(counters, swept)
        counters.look_everywhere()  # blocks do not note which patches lines hit
        BreadthFirst().run(counters, swept)  # the last few lines, if any are left

    def _due(self, counters: FiringCounters) -> int:
        """Return the number of lines that are due in all blocks."""
        wavefront, _ = due_between(counters, 0, counters.total)
        return 0 if wavefront is None else wavefront.total

    def _pass(self, counters: FiringCounters, swept: Swept) -> None:
        """Fire the lines of a pass."""
        for block in range(BLOCKS):
            wavefront, largest = due_between(counters, counters.total * block // BLOCKS, counters.total * (block + 1) // BLOCKS)
            if wavefront is not None:
                fire(counters, wavefront, largest)
                swept(wavefront.total)
