"""Breadth-first: sweep after sweep, every patch fires all it owes (Shirley 1991)."""

from . import depth_first

TAIL = 1 << 13  # fewer lines than this are followed to their ends at once: the counters are the same


def run(engine, progress) -> None:
    """Sweep until no patch owes a line. ``progress(lines)`` is called after each sweep."""
    while True:
        batch, largest = engine.due()
        if batch is None:
            return
        if batch.total < TAIL and engine.bands is None:
            depth_first.walk_all(engine, batch, progress)
            return
        engine.fire(batch, largest)
        progress(batch.total)
