"""Breadth-first: sweep after sweep, every patch fires all it owes (Shirley 1991)."""

from . import depth_first

TAIL = 1 << 13  # fewer lines than this are followed to their ends at once: the counters are the same


def run(engine, progress) -> None:
    """Sweep until no patch owes a line. ``progress(lines)`` is called after each sweep."""
    while True:
        sweep, largest = engine.due()
        if sweep is None:
            return
        if sweep.total < TAIL and engine.bands is None:
            depth_first.walk_all(engine, sweep, progress)
            return
        engine.fire(sweep, largest)
        progress(sweep.total)
        del sweep  # and the memory it holds
