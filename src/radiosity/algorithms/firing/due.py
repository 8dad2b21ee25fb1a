"""The lines that are due: what rows' target counts exceed their fired counts by, as a wavefront."""

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...sampling.blocks import BLOCK
from ...tally.wraps import PERIOD
from ...tracing.lanes import PIECE, Wavefront, sums
from ...tracing.parts import most_lines, part
from .counters import FiringCounters


def due(counters: FiringCounters) -> tuple[Wavefront | None, int]:
    """Return the lines that are due now, and the largest line number among them."""
    if counters.bands is not None and counters.bands.parted:
        wavefront, largest = _left(counters)
        if wavefront is not None:
            return wavefront, largest
        counters.everywhere = True
    numbers = _candidates(counters)
    wavefront, largest = _wavefront(counters, numbers, 0, counters.total if numbers is None else dr.width(numbers))
    counters.has_due = wavefront is not None
    if not counters.has_due and counters.bands is not None:
        counters.bands.rest()
    return wavefront, largest


def due_between(counters: FiringCounters, low: int, high: int) -> tuple[Wavefront | None, int]:
    """Return the result of `due` for the row numbers from ``low`` to below ``high``; in grey scenes only."""
    return _wavefront(counters, None, low, high - low)


def _candidates(counters: FiringCounters):
    """Return the numbers of the rows that may have to fire a line: those that lines hit since the last call.

    It is None for all rows: in a new stage, or where lines hit many of them.
    """
    types, panes, total, numbers = counters.types, counters.targets.panes, counters.total, None
    if counters.landed is not None:
        numbers = np.unique(counters.landed)
        numbers = numbers[numbers < total]
        numbers = numbers if panes is None else panes.with_others(numbers)
        numbers = upload(types.UInt32, _not_alone(numbers, total))
    elif not counters.everywhere:
        if panes is not None:
            counters.hits.touched = panes.spread(counters.hits.touched)
        numbers = dr.compress(dr.reshape(types.Bool, counters.hits.touched, total, shrink=True))  # no copy of the flags
    if counters.landed is None:
        counters.hits.forget_touched()
    counters.everywhere, counters.landed = False, None
    return numbers


def _not_alone(numbers: np.ndarray, total: int) -> np.ndarray:
    """Append another row to a single one: arrays of one entry would compile kernels of their own."""
    if len(numbers) == 1 and total > 1:
        return np.append(numbers, (numbers[0] + 1) % total).astype(np.uint32)
    return numbers


def _wavefront(counters: FiringCounters, numbers, low: int, size: int) -> tuple[Wavefront | None, int]:
    """Return the wavefront of row numbers (None: of ``size`` rows from ``low`` on), and its largest line number.

    With bands, all rows are taken in pieces, to save memory, and hit counts are kept in place of counts of lines.
    """
    types, bands, wide, counts = counters.types, counters.bands, counters.wide, None
    u32 = types.UInt32
    total, largest = dr.opaque(types.UInt64, 0, 2), dr.opaque(u32, 0, 2)
    keep = bands is None or size <= PIECE or wide
    step = PIECE if numbers is None and bands is not None and not wide else max(size, 1)
    for start in range(0, size, step):
        width = min(step, size - start)
        places = dr.arange(u32, width) + dr.opaque(u32, start)
        piece = places + dr.opaque(u32, low) if numbers is None else numbers
        read = None if numbers is None and width == counters.total and not wide else piece
        arrivals = counters.targets.read(counters.hits.arrivals, read)
        counts = _count(counters, read, arrivals, total, largest)
        dr.eval(total, largest, *([counts] if keep else []), *([arrivals] if bands is not None else []))
        if bands is not None:
            bands.weigh(counters, piece, places, arrivals, counts)
    lines, most = int(total[0]), _most(counters)
    counters.parted = lines > most and (bands is None or _can_be_parted(counters, numbers))
    if not lines:
        return None, 0
    if counters.parted and bands is not None:
        return _left(counters)
    if counters.parted:
        counts = part(types, counts, most / lines)
        (lines,) = sums(types, counts)
    blocks = counters.blocks if wide else None
    return Wavefront(numbers, low, size, lines, counts if keep else None, blocks), int(largest[0])


def _most(counters: FiringCounters) -> int:
    """Return the most lines of a wavefront; where others fire it, each gets a part of it."""
    if counters.firer is not None:
        return counters.firer.most
    return most_lines(counters.tracer.geometry.device.name, counters.total, even=counters.rounds is not None)


def _can_be_parted(counters: FiringCounters, numbers) -> bool:
    """Return whether a wavefront with bands may be fired in parts: one of all rows, that is neither wide nor coherent."""
    return numbers is None and not counters.wide and counters.rounds is None


def _left(counters: FiringCounters) -> tuple[Wavefront | None, int]:
    """Return what is left of a wavefront with bands that is fired in parts, or a part of it; None where nothing is left.

    Its lines, and what they carry, were fixed before its first part. So parts bring what the whole would.
    """
    types, bands = counters.types, counters.bands
    assert bands is not None
    targets = counters.target_counts_before(counters.rows())
    counts, largest = targets - counters.targets.read(counters.fired, None), dr.max(targets)
    dr.eval(counts, largest)
    (lines,), most = sums(types, counts), _most(counters)
    bands.parted = lines > most
    if not lines:
        return None, 0
    if bands.parted:
        counts = part(types, counts, most / lines)
        (lines,) = sums(types, counts)
    counters.parted = True
    return Wavefront(None, 0, counters.total, lines, counts), int(largest[0])


def _count(counters: FiringCounters, numbers, arrivals, total, largest):
    """Return how many lines row numbers must fire now, and update their sum and the largest line number; in a kernel."""
    types, none = counters.types, dr.zeros(counters.types.UInt32, dr.width(arrivals))
    if counters.wide:
        counts, targets = _wide_counts(counters, numbers, arrivals), dr.full(types.UInt32, BLOCK - 1, dr.width(arrivals))
    else:
        targets = counters.targets.after(numbers, arrivals, counters.hits.arrivals)
        counts = targets - counters.targets.read(counters.fired, numbers)
    dr.scatter_add(total, types.UInt64(counts), none, mode=dr.ReduceMode.Expand)
    dr.scatter_reduce(dr.ReduceOp.Max, largest, targets, none, mode=dr.ReduceMode.Expand)
    return counts


def _wide_counts(counters: FiringCounters, number, arrivals):
    """Return how many lines row numbers fire in a wide wavefront: `PERIOD` at most, all in one block; in a kernel."""
    u32, wide = counters.types.UInt32, counters.types.UInt64
    fired = counters.fired_upper.whole(counters.targets.read(counters.fired, number), number)
    left = wide(BLOCK) - ((fired + 1) & wide(BLOCK - 1))
    lines = counters.targets.after_wide(number, arrivals, counters.hits) - fired
    return u32(dr.minimum(dr.minimum(lines, left), wide(PERIOD)))
