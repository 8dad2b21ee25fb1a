"""Depth-first: a lane follows its particle from patch to patch until it is absorbed (Sbert 1997).

The arrival that raises what a patch owes fires the patch's next line. Which lane that is depends on the race, but every
arrival and every line number is claimed once, by an atomic counter, so the counters end as in any other order.
"""

import drjit as dr


def run(engine, progress) -> None:
    """Follow all walks to their ends."""
    types = engine.types
    deficit = engine.owed() - engine.fired
    before = dr.sum(types.UInt64(engine.fired))
    dr.eval(deficit, before)
    for lanes in engine.lanes(deficit):
        walk(engine, lanes)
        after = dr.sum(types.UInt64(engine.fired))
        progress(int(after[0]) - int(before[0]))
        before = after


def walk(engine, lanes) -> None:
    """One lane for each line owed at the start."""
    types = engine.types
    number, _ = engine.read(lanes)

    def body(number, going):
        index = dr.scatter_inc(engine.fired, number, going) + 1
        landed = engine.trace(number, index, 32)
        before = dr.scatter_inc(engine.arrivals, landed, going)
        going = going & (landed < engine.total)
        patch = landed - engine.replicate(landed) * engine.n_opaque
        wide = types.UInt64
        rho = wide(dr.gather(types.UInt32, engine.rho, patch, going))
        rest = wide(dr.gather(types.UInt32, engine.fraction, patch, going)) + wide(dr.gather(types.UInt32, engine.phase, landed, going))
        low = rho * wide(before) + rest
        going &= ((low + rho) >> 32) > (low >> 32)
        return landed, going

    going = dr.full(types.Bool, True, lanes.count)
    dr.while_loop((number, going), lambda number, going: going, body, mode="symbolic")
    dr.eval(engine.arrivals, engine.fired)
