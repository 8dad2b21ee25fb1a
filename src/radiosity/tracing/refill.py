"""A loop over walks in which lanes stay full: a lane whose walk has ended takes another one.

Lanes run in packets (of 16 on a CPU, 32 on a GPU), and a packet runs until its longest walk has ended. With one walk a lane most
lanes wait: of walks that go on with probability 1/2, a packet of 16 makes 5.3 steps where 2 would do.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

from ..device.launches import shared
from ..device.recorded import loop

MOST = 128  # walks of a lane, where they are many: the more, the shorter the wait for the lane that takes longest
LEAST = 1024  # lanes for each thread
CUDA_LEAST = 1 << 20  # lanes on a GPU, which needs so many to be busy

Step = Callable[[list, tuple, Any], tuple[list, tuple, Any]]


def lanes_for(types, walks: int) -> int:
    """Return the number of lanes for a number of walks; 2 or more, since arrays of one entry would compile other kernels."""
    cuda = dr.backend_v(types.UInt32) is dr.JitBackend.CUDA
    least = CUDA_LEAST if cuda else LEAST * dr.thread_count()
    each = min(max(walks // least, 1), MOST)
    return max(-(-walks // each), 2)


def follow(types, starts: list, walks: int, sums: tuple, step: Step, arrays: Callable[[], list]) -> tuple:
    """Follow walks until all have ended, in one launch.

    Lane i follows the walks i, i + lanes, i + 2 lanes, ... one after the other. What walks add to ``arrays`` are whole numbers,
    so the result does not depend on that.

    Args:
        starts: columns of ``walks`` entries or more: the state in which each walk begins.
        sums: what each lane sums over its walks, `lanes_for` entries: zeros.
        step: takes columns, sums and the mask of lanes that have a walk; returns the next columns and sums, and which walks go
            on. It is recorded once.
        arrays: returns the arrays that steps write to.

    Returns:
        The sums of all lanes; not evaluated.
    """
    u32, lanes = types.UInt32, lanes_for(types, walks)
    stride, end = dr.opaque(u32, lanes), dr.opaque(u32, walks)
    dr.eval(starts)

    def taken(place, active):
        return [dr.gather(type(column), column, place, active) for column in starts]

    def body(columns, sums, place, going):
        after, sums, on = step(columns, sums, going)
        on = going & on
        place = dr.select(on, place, place + stride)
        fresh = going & ~on & (place < end)
        # walks that ended keep their columns, which are valid places
        after = [dr.select(on, new, old) for new, old in zip(after, columns, strict=True)]
        columns = [dr.select(fresh, new, old) for new, old in zip(taken(place, fresh), after, strict=True)]
        return columns, sums, place, on | fresh

    place = dr.arange(u32, lanes)
    going = place < end
    state = (taken(dr.select(going, place, u32(0)), True), sums, place, going)
    _, sums, _, _ = loop(state, lambda columns, sums, place, going: going, body)
    with shared(lanes):
        dr.eval(*arrays(), *sums)
    return sums
