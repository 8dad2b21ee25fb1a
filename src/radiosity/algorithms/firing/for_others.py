"""Lines that another machine asks for: they are fired here, and their hits go back to it."""

import numpy as np

from ...device.backend import frozen, upload
from ...tracing.lanes import Wavefront
from .counters import FiringCounters
from .elsewhere import Hits, Lines
from .fire import fire


def fire_here(counters: FiringCounters, lines: Lines) -> Hits:
    """Fire lines with the counters of their replicate alone, which are of use for nothing else."""
    types, tracer, bands, n = counters.types, counters.tracer, counters.bands, counters.tracer.n
    zero = np.zeros((1, n), np.uint32)
    counters.hits.write(zero, np.zeros((2, 1), np.uint32))
    fired = np.zeros(n, np.uint64)
    fired[lines.rows] = lines.fired
    counters.fired = upload(types.UInt32, counters.fired_upper.of(fired))
    if bands is not None and lines.weights is not None:
        bands.weights = upload(types.UInt32, lines.weights)
        bands.received = upload(types.UInt64, np.zeros(tracer.slots * bands.n, np.uint64))
        bands.upper["received"].halves = bands.upper["missed"].halves = None
    blocks = None
    if lines.wide:
        tracer.blocks.prepare(counters.fired_upper.largest + 1)
        blocks = counters.blocks
    numbers, counts = upload(types.UInt32, lines.rows), upload(type(counters.fired), lines.counts)
    fire(counters, Wavefront(numbers, 0, len(lines.rows), lines.total, counts, blocks), lines.largest)
    arrivals, missed = counters.hits.read()
    received = None if bands is None else frozen(bands.received).reshape(-1, bands.n).copy()
    return Hits(
        lines.replicate,
        arrivals[0].copy(),
        missed[:, 0].copy(),
        None if received is None else received[:n],
        None if received is None else received[n:],
    )
