"""Breadth-first: sweep after sweep, every patch fires all it owes (Shirley 1991)."""

from . import depth_first

TAIL = 1 << 13  # fewer lines than this are followed to their ends at once: the counters are the same


def run(engine, progress) -> None:
    """Wavefront until no patch owes a line. ``progress(lines)`` is called after each sweep."""
    while True:
        wavefront, largest = engine.due()
        if wavefront is None:
            return
        if wavefront.total < TAIL and engine.bands is None:
            depth_first.walk_all(engine, wavefront, progress)
            return
        engine.fire(wavefront, largest)
        progress(wavefront.total)
        del wavefront  # and the memory it holds
