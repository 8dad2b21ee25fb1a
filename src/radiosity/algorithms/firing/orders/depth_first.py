"""Depth-first order: a lane follows its particle from patch to patch until it is absorbed (Sbert 1997).

The hit that raises the target count of a patch fires the patch's next line. Which lane this is depends on timing, but every
hit and every line number is claimed once, by an atomic counter, so the counters end as in any other order.
"""

from typing import Any

import drjit as dr

from ....device.recorded import loop
from ....tracing.lanes import Launch, Wavefront
from ...base import Swept
from ..counters import FiringCounters
from .base import AbstractOrder


class DepthFirst(AbstractOrder):
    """Follows all walks until they are absorbed."""

    def run(self, counters: FiringCounters, swept: Swept) -> None:
        wavefront, _ = counters.due()
        if wavefront is not None:
            walk_all(counters, wavefront, swept)


def walk_all(counters: FiringCounters, wavefront: Wavefront, swept: Swept) -> None:
    """Follow walks from the lines of a wavefront, one launch at a time."""
    for batch in list(counters.batches(wavefront)):  # made before walks fire lines of patches of later batches
        for launch in batch.launches(counters.types):
            before = counters.lines
            walk(counters, launch)
            swept(counters.lines - before)


def walk(counters: FiringCounters, launch: Launch) -> None:
    """Follow the walks of a launch, with one lane for each line that is due at the start."""
    types, tracer = counters.types, counters.tracer
    number, _, _ = launch.read(types)

    def body(number, going):
        taken: Any = dr.scatter_inc(counters.fired, number, going)
        landed = tracer.trace(number, taken + 1, tracer.record(number), 32)
        before = dr.scatter_inc(counters.hits.arrivals, landed, going)
        going = going & (landed < counters.total)
        return landed, going & counters.is_due_after(landed, before, going)

    loop((number, launch.real(types)), lambda number, going: going, body)
    dr.eval(counters.hits.arrivals, counters.fired)
