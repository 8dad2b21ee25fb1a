"""Patch after patch, in the order of their numbers: each fires what it lacks to its share of power (WDRS, Neumann, Neumann
and Bekaert 1997).

A block of patches fires at a time; light that lands ahead leaves in the same pass, light that lands behind in the next.
The set of lines is the same as in any other order.
"""

from . import breadth_first

BLOCKS = 8


def run(engine, progress) -> None:
    """Pass over the blocks until no patch owes a line. ``progress(lines)`` is called after each block."""
    if engine.bands is not None or engine.total < BLOCKS:
        breadth_first.run(engine, progress)
        return
    while True:
        fired = 0
        for block in range(BLOCKS):
            wavefront, largest = engine.due_between(engine.total * block // BLOCKS, engine.total * (block + 1) // BLOCKS)
            if wavefront is not None:
                engine.fire(wavefront, largest)
                progress(wavefront.total)
                fired += wavefront.total
        if fired < breadth_first.TAIL:
            engine.everywhere, engine.landed = True, None  # blocks kept no account of where lines landed
            breadth_first.run(engine, progress)  # the last few, and none where none are left
            return
