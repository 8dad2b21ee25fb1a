"""Breadth-first: sweep after sweep, every patch fires all it owes (Shirley 1991)."""

import drjit as dr

from . import depth_first

TAIL = 1 << 13  # fewer lines than this are followed to their ends at once: the counters are the same


def run(engine, progress) -> None:
    """Sweep until no patch owes a line. ``progress(lines)`` is called after each sweep."""
    while count := sweep(engine):
        progress(count)
        if count < TAIL and engine.bands is None:
            depth_first.run(engine, progress)


def sweep(engine) -> int:
    """Fire every line owed now; the number of them."""
    owed = engine.owed()
    deficit = owed - engine.fired
    largest, total = dr.max(owed), dr.sum(engine.types.UInt64(deficit))
    dr.eval(owed, deficit, largest, total)
    count = int(total[0])
    if count == 0:
        return 0
    if engine.bands is not None:
        engine.bands.weigh(deficit)
    bits = engine.numbers.bits_for(int(largest[0]))
    boxes = engine.boxes_for(deficit) if engine.method.coherent else None
    for lanes in engine.lanes(deficit):
        engine.fire(lanes, bits, boxes)
    engine.fired = owed
    return count
