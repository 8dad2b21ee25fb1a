"""Chords: lines through the whole scene, and their spans, line by line, and along each line in order."""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen
from ...device.recorded import loop
from ..bvh import REACH
from ..lanes import paired
from .crossing import CODES, ESCAPED, ONE_WAY, PENDING, Crossings
from .walking import Sink, step

MARGIN = 1e-5 * 2.0**REACH  # lines begin this far outside the scene's box, half of which is at most 2^REACH long


@dataclass(frozen=True, eq=False)
class Walked:
    """Spans of some lines, on the host: number of the line, and the two ends, line by line and along each in order."""

    line: np.ndarray
    one: np.ndarray
    other: np.ndarray


def crossing_box(origin, direction, low, high):
    """Return whether lines meet a box, the distance at which they enter it, and the axis across which that side lies."""
    inverse = 1 / direction
    one, two = (low - origin) * inverse, (high - origin) * inverse
    each = dr.minimum(one, two)
    near, far = dr.max(each), dr.min(dr.maximum(one, two))
    UInt32 = dr.uint32_array_t(type(near))
    axis = dr.select(each[0] == near, UInt32(0), dr.select(each[1] == near, UInt32(1), UInt32(2)))
    return near <= far, near, axis


def walk(crossings: Crossings, index: Any, count: int, line, capacity: int, *, coherent: bool) -> Walked:
    """Return all spans of the lines ``index``.

    Args:
        index: UInt32, numbers of lines, in any order.
        count: all numbers are below it.
        line: turns numbers into origins, directions, a mask of the lines that begin behind the first face already, and the
            patches on which those begin.
        capacity: the number of spans for which there is room at first.
    """
    types = crossings.geometry.device.types
    UInt32 = types.UInt32
    lines = dr.width(index)
    if lines == 0:
        none = np.zeros(0, np.uint32)
        return Walked(none, none, none)
    index = paired(types, index)
    while True:
        sink = Sink.of(types, capacity, count)
        _walk(crossings, index, lines, line, sink, coherent)
        found = int(sink.counter[0])
        if found <= capacity:
            break
        capacity = found
    if found == 0:
        none = np.zeros(0, np.uint32)
        return Walked(none, none, none)
    # put in order: along the lines, line by line
    begins = dr.prefix_sum(sink.counts)
    dr.eval(begins)
    row = paired(types, dr.arange(UInt32, found))
    number, rank, one, other = dr.gather(types.Array4u, sink.records, row)
    at = dr.gather(UInt32, begins, number) + rank
    columns = [dr.opaque(UInt32, 0, found) for _ in range(3)]
    for column, values in zip(columns, (number, one, other), strict=True):
        dr.scatter(column, values, at)
    dr.eval(columns)
    number, one, other = (np.array(frozen(column)) for column in columns)
    return Walked(number, *_resolved(one, other))


def _walk(crossings: Crossings, index, lines: int, line, sink: Sink, coherent: bool) -> None:
    """Follow lines until they end, all in one kernel."""
    types = crossings.geometry.device.types
    UInt32, Bool, width = types.UInt32, types.Bool, dr.width(index)
    crossings.prepare()
    going = dr.arange(UInt32, width) < dr.opaque(UInt32, lines)
    origin, direction, within, first = line(index)
    start = dr.select(within, first, UInt32(ESCAPED))

    def body(*state):
        return step(crossings, index, direction, state, sink, coherent)

    state = (types.Array3f(origin), going, dr.full(Bool, False, width), start, start, dr.zeros(UInt32, width))
    loop(state, lambda origin, going, *rest: going, body)
    dr.eval(sink.counter, sink.records, sink.counts)


def _resolved(one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fill in what is seen through backs that let lines pass: what the next span of the line ends on, seen from one side only."""
    pending = other == PENDING
    if pending.any():
        at = np.where(pending, len(other), np.arange(len(other)))
        after = np.minimum.accumulate(at[::-1])[::-1]
        seen = other[after]
        other = np.where(pending, np.where(seen < CODES, seen | np.uint32(ONE_WAY), seen), other)
    return one, other
