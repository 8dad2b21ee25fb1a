"""Breadth-first: sweep after sweep, every patch fires all it owes (Shirley 1991)."""

import drjit as dr


def run(engine, progress) -> None:
    """Sweep until no patch owes a line. ``progress()`` is called after each sweep."""
    while sweep(engine):
        progress()


def sweep(engine) -> int:
    """Fire every line owed now; the number of them."""
    types = engine.types
    owed = engine.owed()
    deficit = owed - engine.fired
    largest, total = dr.max(owed), dr.sum(types.UInt64(deficit))
    dr.eval(owed, deficit, largest, total)
    count = int(total[0])
    if count == 0:
        return 0
    bits = engine.numbers.bits_for(int(largest[0]))
    for lanes in engine.lanes(deficit):
        number, index = engine.read(lanes)
        landed = engine.trace(number, index, bits)
        dr.scatter_add(engine.arrivals, types.UInt32(1), landed)
        dr.eval(engine.arrivals)
    engine.fired = owed
    engine.lines += count
    return count
