"""Firing: the lines of a wavefront are traced, and their hits counted."""

from collections.abc import Iterator
from functools import partial

import drjit as dr
import numpy as np

from ...device.backend import frozen
from ...device.launches import shared
from ...device.recorded import loop
from ...tally.hit_tally import AbstractHitTally, hit_tally
from ...tally.wraps import PERIOD
from ...tracing.lanes import Batch, Launch, Wavefront
from ..base import Interrupted
from .counters import FiringCounters
from .elsewhere import fire_elsewhere

MANY = 4  # after wavefronts of at least a line for 4 rows, all rows are looked through, and no flags are kept
FEW = 1 << 13  # up to this many lines, the host sorts the slots that they hit: that is faster than to look through all flags
# 8, 4 or 2 lines of a lane, in wavefronts of 250 000 lines a thread, once as many lines have been fired
SHIFTS, MUCH = (3, 2, 1), 250_000


def fire(counters: FiringCounters, wavefront: Wavefront, largest: int) -> None:
    """Trace all lines of a wavefront and count their hits.

    Args:
        largest: the largest line number of the wavefront.

    Raises:
        Interrupted: they were fired elsewhere, and the run is to end; the counters are whole.
    """
    firer = counters.firer
    if firer is not None and wavefront.total >= firer.least:
        fire_elsewhere(counters, wavefront, largest, firer)
        if firer.over:
            raise Interrupted("interrupted")
        return
    bits = counters.tracer.numbers.bits_for(largest)
    few = wavefront.total <= FEW and wavefront.blocks is None and not counters.parted
    everywhere = wavefront.blocks is not None or counters.parted or (not few and MANY * wavefront.total >= counters.total)
    tally, landed = hit_tally(counters.hits, wavefront.total, flags=not few and not everywhere), []
    shifts = () if few else _shifts(counters, wavefront)
    for batch in batches(counters, wavefront, shifts):
        for launch in _launches(counters, batch, shifts):
            places = _fire(counters, launch, 32 if few else bits, few, tally)
            if few:
                landed.append(frozen(places)[: launch.lanes])
            counters.unseen += launch.lanes << (max(SHIFTS) if launch.batch.several else 0)
            if counters.unseen > PERIOD:
                tally.settle()
                counters.look()
                tally = hit_tally(counters.hits, wavefront.total, flags=not few and not everywhere)
        dr.scatter(counters.fired, batch.fired + batch.counts, batch.numbers, active=batch.counts > 0)
        if counters.bands is not None:
            counters.bands.count_fired(counters, batch)
        dr.eval(counters.fired)
    tally.settle()
    counters.swept += wavefront.total
    counters.everywhere, counters.landed = everywhere, np.concatenate(landed) if few else None


def batches(counters: FiringCounters, wavefront: Wavefront, shifts: tuple[int, ...] = ()) -> Iterator[Batch]:
    """Yield the batches of a wavefront, with 2^shift lines a lane."""
    tracer = counters.tracer
    return wavefront.batches(counters.types, counters.target_counts_before, counters.fired, tracer.record, shifts)


def _launches(counters: FiringCounters, batch: Batch, shifts: tuple[int, ...]) -> Iterator[Launch]:
    """Yield the launches of a batch, those of packets first."""
    rounds = counters.rounds
    for part in [batch] if rounds is None else rounds.split(counters.tracer, batch, shifts):
        yield from part.launches(counters.types)


def _shifts(counters: FiringCounters, wavefront: Wavefront) -> tuple[int, ...]:
    """Return the binary logarithms of the lines of a lane; () for one line a lane.

    What the lines of a row have in common is then found once for all of them. It needs one more kernel, which takes time to
    compile, so short runs do not use it. It leaves fewer lanes, so many threads, and a GPU even more, do not use it.
    """
    cpu = counters.tracer.geometry.device.name == "cpu"
    many = cpu and min(wavefront.total, counters.swept) >= MUCH * dr.thread_count()
    return SHIFTS if many else ()


def _fire(counters: FiringCounters, launch: Launch, bits: int, few: bool, tally: AbstractHitTally):
    """Trace the lines of one launch. Return the slots that they hit where there are few lines."""
    types, tracer, bands = counters.types, counters.tracer, counters.bands
    number, first, record = launch.read(types)
    replicate = tracer.replicate_or_none(number)
    lines = tracer.leave(record)
    powers = [] if bands is None else bands.carried(types, launch)
    block, boxes = launch.block(types), launch.batch.boxes

    def trace(numbers, active):
        landed = tracer.land_in(lines(numbers), replicate, boxes is not None, active)
        tally.add(landed, powers, active)
        return landed

    def turn_by_turn(turn):
        trace(points(turn), True)
        return (turn + 1,)

    landed = None
    if not launch.batch.several:
        landed = trace(tracer.points(number, first, replicate, record, bits, block), launch.mask(types, always=few))
    else:
        if boxes is None:
            points = tracer.points_in_turn(first, number, replicate, record, bits, 1 << max(SHIFTS), block)
        else:
            index = boxes.turns(types, first, launch.rank)
            points = partial(tracer.points_at, index, number, replicate, record, bits, block)
        tracer.geometry.prepare_hits()  # nothing can be made in a loop
        count = launch.lines(types, first)
        loop((types.UInt32(0),), lambda turn: turn < count, turn_by_turn)
    if few:
        dr.schedule(landed)
    with shared(launch.lanes):
        dr.eval(*tally.arrays())
    return landed
