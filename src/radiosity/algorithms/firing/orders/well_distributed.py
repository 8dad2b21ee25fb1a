"""Row after row, in the order of their numbers: each fires what it lacks to its share of power (WDRS, Neumann, Neumann and
Bekaert 1997).

A block of rows fires at a time; light that lands ahead leaves in the same pass, light that lands behind in the next.
The set of lines is the same as in any other order.
"""

from ...base import Swept
from ..counters import FiringCounters
from .base import AbstractOrder
from .breadth_first import TAIL, BreadthFirst

BLOCKS = 8


class WellDistributed(AbstractOrder):
    """Passes over the blocks until no row owes a line."""

    def run(self, counters: FiringCounters, swept: Swept) -> None:
        if counters.bands is not None or counters.total < BLOCKS:
            BreadthFirst().run(counters, swept)
            return
        while self._passed(counters, swept) >= TAIL:
            pass
        counters.look_everywhere()  # blocks kept no account of where lines landed
        BreadthFirst().run(counters, swept)  # the last few, and none where none are left

    def _passed(self, counters: FiringCounters, swept: Swept) -> int:
        """Lines of a pass."""
        fired = 0
        for block in range(BLOCKS):
            wavefront, largest = counters.due_between(counters.total * block // BLOCKS, counters.total * (block + 1) // BLOCKS)
            if wavefront is not None:
                counters.fire(wavefront, largest)
                swept(wavefront.total)
                fired += wavefront.total
        return fired
