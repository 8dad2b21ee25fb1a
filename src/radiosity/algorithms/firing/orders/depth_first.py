"""Depth-first order: a lane follows its particle from patch to patch until it is absorbed, then another one (Sbert 1997).

The hit that raises the target count of a patch fires the patch's next line. Which lane this is depends on timing, but every
hit and every line number is claimed once, by an atomic counter, so the counters end as in any other order. Such counters have 32
bits. Where these may be too few (`FiringCounters.wide`), lines are fired in wavefronts, to the same integers.
"""

from typing import Any

import drjit as dr

from ....tally.wraps import PERIOD
from ....tracing.lanes import Launch, Wavefront
from ....tracing.refill import follow
from ...base import Swept
from ..counters import FiringCounters
from ..due import due
from ..fire import batches, fire
from .base import AbstractOrder


class DepthFirst(AbstractOrder):
    """Follows all walks until they are absorbed."""

    def run(self, counters: FiringCounters, swept: Swept) -> None:
        while True:
            wavefront, largest = due(counters)
            if wavefront is None:
                return
            if wavefront.blocks is not None:
                fire(counters, wavefront, largest)
                swept(wavefront.total)
                continue
            walk_all(counters, wavefront, swept)
            if not more_is_due(counters):
                return


def more_is_due(counters: FiringCounters) -> bool:
    """Return whether lines may be due after the walks from the lines of a wavefront.

    Walks end on diffusing panes, where others begin; and the wavefront may have had a part of the lines that were due.
    """
    return counters.targets.panes is not None or counters.wide or counters.parted


def walk_all(counters: FiringCounters, wavefront: Wavefront, swept: Swept) -> None:
    """Follow walks from the lines of a wavefront, one launch at a time."""
    counters.look_everywhere()  # where ``swept`` ends the work, lines of later launches are due
    before = counters.lines
    limit = max(int(PERIOD * counters.source.least_absorbed), 2)  # so that walks of a launch have `PERIOD` lines at most
    for batch in list(batches(counters, wavefront)):  # made before walks fire lines of patches of later batches
        for launch in batch.launches(counters.types, limit=limit):
            walk(counters, launch)
            after = counters.lines
            counters.unseen += after - before
            if counters.unseen > PERIOD:
                counters.look()
            swept(after - before)
            before = after
            if counters.wide:
                return  # what is left is due in the next wavefront


def walk(counters: FiringCounters, launch: Launch) -> None:
    """Follow the walks that begin with the lines of a launch."""
    types, tracer = counters.types, counters.tracer
    number, _, _ = launch.read(types)

    def step(columns, sums, going):
        (number,) = columns
        taken: Any = dr.scatter_inc(counters.fired, number, going)
        landed = tracer.trace(number, taken + 1, tracer.record(number), 32)
        before = dr.scatter_inc(counters.hits.arrivals, landed, going)
        going = going & (landed < counters.total)
        return [landed], sums, going & counters.targets.is_raised(landed, before, going)

    follow(types, [number], launch.lanes, (), step, lambda: [counters.hits.arrivals, counters.fired])
