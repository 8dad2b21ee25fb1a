"""Parts of many lines that are fired together: after each, a run can be stopped, or its checkpoint written.

The k-th line of a row is a function of k, and what lines bring are whole numbers. So parts bring what all lines at once would.
"""

from typing import Any

import drjit as dr

# Most lines of a part, in small scenes and in large ones: a few seconds of a GPU, or of so many threads.
MOST = {"cpu": (1 << 24, 1 << 25), "cuda": (1 << 32, 1 << 32)}
THREADS = 2
A_ROW = 8  # lines for each row, from which passes over all rows take little of the time


def most_lines(device: str, rows: int, even: bool = False) -> int:
    """Return the most lines of a part; where it is to be even, the same on any number of threads, as packets need it."""
    small, large = MOST[device]
    if device == "cpu" and not even and dr.thread_count() < THREADS:
        small, large = small // THREADS, large // THREADS
    return min(max(A_ROW * rows, small), large)


def part(types: Any, counts: Any, share: float) -> Any:
    """Return counts of a share of the lines of each row, UInt32, at least one line of a row that has any."""
    share = dr.opaque(types.Float64, share)
    some = dr.minimum(types.UInt32(types.Float64(counts) * share) + 1, counts)
    dr.eval(some)
    return some
