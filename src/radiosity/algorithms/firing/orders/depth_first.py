"""Depth-first: a lane follows its particle from patch to patch until it is absorbed (Sbert 1997).

The arrival that raises what a patch owes fires the patch's next line. Which lane that is depends on the race, but every
arrival and every line number is claimed once, by an atomic counter, so the counters end as in any other order.
"""

from typing import Any

import drjit as dr

from ....device.recorded import loop


def run(engine, progress) -> None:
    """Follow all walks to their ends. ``progress(lines)`` is called after each launch."""
    wavefront, _ = engine.due()
    if wavefront is not None:
        walk_all(engine, wavefront, progress)


def walk_all(engine, wavefront, progress) -> None:
    """From the lines of a sweep, a launch at a time."""
    for batch in list(engine.batches(wavefront)):  # made before walks fire lines of patches that are still to come
        for launch in batch.launches(engine.types):
            before = engine.lines
            walk(engine, launch)
            progress(engine.lines - before)


def walk(engine, launch) -> None:
    """One lane for each line owed at the start."""
    types = engine.types
    number, _, _ = launch.read(types)

    def body(number, going):
        taken: Any = dr.scatter_inc(engine.fired, number, going)
        index = taken + 1
        landed = engine.trace(number, index, engine.record(number), 32)
        before = dr.scatter_inc(engine.arrivals, landed, going)
        going = going & (landed < engine.total)
        patch = landed - engine.replicate(landed) * engine.n_opaque
        wide = types.UInt64
        rho = wide(dr.gather(types.UInt32, engine.rho, patch, going))
        rest = wide(dr.gather(types.UInt32, engine.fraction, patch, going)) + wide(
            dr.gather(types.UInt32, engine.phase, landed, going)
        )
        low = rho * wide(before) + rest
        going &= ((low + rho) >> 32) > (low >> 32)
        return landed, going

    going = launch.real(types)
    loop((number, going), lambda number, going: going, body)
    dr.eval(engine.arrivals, engine.fired)
