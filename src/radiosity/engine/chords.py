"""Lines through the whole scene, and their spans.

A line is walked from face to face. The side of a face that looks forward begins a span, the next side that looks backward ends
it. Where backs let lines pass, two sides need not see each other: one looks through a back whose front hides the other.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from .crossing import ESCAPED, LOST, Crossings
from .device import frozen
from .lanes import paired

PENDING, NOBODY = 0xFFFFFFFB, 0xFFFFFFFA
ONE_WAY = 1 << 31  # of a patch number: `one` sees it, but it does not see `one`
CODES = NOBODY  # larger numbers are no patches
MARGIN = 1e-5  # lines begin this far outside the scene's box, in the caster's units, which make it 2 to 4 long
WIDE = 64  # entries of a counter: arrays of one entry compile kernels of their own


@dataclass(frozen=True, eq=False)
class Walked:
    """Spans of some lines, on the host: number of the line's lane, and the two ends, along each line in order."""

    lane: np.ndarray
    one: np.ndarray
    other: np.ndarray


def crossing_box(origin, direction, low, high):
    """Whether lines meet a box; where they enter it, as a distance; and through a side across which axis."""
    inverse = 1 / direction
    one, two = (low - origin) * inverse, (high - origin) * inverse
    each = dr.minimum(one, two)
    near, far = dr.max(each), dr.min(dr.maximum(one, two))
    UInt32 = dr.uint32_array_t(type(near))
    axis = dr.select(each[0] == near, UInt32(0), dr.select(each[1] == near, UInt32(1), UInt32(2)))
    return near <= far, near, axis


def walk(crossings: Crossings, index: Any, line, capacity: int, *, coherent: bool) -> Walked:
    """All spans of the lines ``index``.

    Args:
        index: UInt32, numbers that ``line`` turns into origins, directions, and, as a mask and patches, whether lines begin
            behind the first face already, and on which patch.
        capacity: spans that there is room for at first.
    """
    types = crossings.geometry.device.types
    UInt32 = types.UInt32
    lines = dr.width(index)
    if lines == 0:
        none = np.zeros(0, np.uint32)
        return Walked(none, none, none)
    index = paired(types, index)
    width = dr.width(index)
    while True:
        counter, records = dr.opaque(UInt32, 0, WIDE), dr.opaque(UInt32, 0, 4 * capacity)
        begins, found = _walk(crossings, index, lines, line, counter, records, capacity, coherent)
        if found <= capacity:
            break
        capacity = found
    if found == 0:
        none = np.zeros(0, np.uint32)
        return Walked(none, none, none)
    # put in order: along the lines, line by line
    row = paired(types, dr.arange(UInt32, found))
    lane, depth, one, other = dr.gather(types.Array4u, records, row)
    at = dr.gather(UInt32, begins, lane) + depth
    columns = [dr.opaque(UInt32, 0, found) for _ in range(3)]
    for column, values in zip(columns, (lane, one, other), strict=True):
        dr.scatter(column, values, at)
    dr.eval(columns)
    lane, one, other = (np.array(frozen(column)) for column in columns)
    assert width >= lines
    return Walked(lane, *_resolved(one, other))


def _walk(crossings: Crossings, index, lines: int, line, counter, records, capacity: int, coherent: bool):
    """Walk lines and append records (lane, rank of the span on its line, one, other) in any order; the rank of each lane's first
    record among all, and how many there are."""
    geometry = crossings.geometry
    types = geometry.device.types
    UInt32, Bool = types.UInt32, types.Bool
    lane = dr.arange(UInt32, dr.width(index))
    origin, direction, within, first = line(index)
    limit = dr.opaque(UInt32, capacity)

    def body(origin, going, blind, open_, seen, depth):
        face = crossings.next(origin, direction, going & ~blind, coherent=coherent)
        one, other, emit = open_, face.near, (open_ < CODES) | (face.near < CODES)
        if geometry.some_backs_pass:
            alone = open_ == NOBODY  # of what lies behind, only what looks back from here matters
            through = alone & (seen < CODES)
            one, other = dr.select(through, face.near, dr.select(alone, seen, one)), dr.select(through, seen | ONE_WAY, other)
            emit = dr.select(alone, face.near < CODES, emit)
            # a back that lets lines pass: what looks on sees what its front will see
            other = dr.select(face.near_passes, UInt32(PENDING), other)
            emit = dr.select(face.near_passes, open_ < CODES, emit)
        emit &= going
        slot = dr.scatter_inc(counter, UInt32(0), active=emit)
        dr.scatter(records, types.Array4u(lane, depth, one, other), slot, active=emit & (slot < limit))
        open_, seen = face.far, dr.select(face.far_passes, seen, face.far)
        if geometry.some_backs_pass:
            open_ = dr.select(face.far_passes, UInt32(NOBODY), open_)
        # behind the hull's faces there is nothing to trace; a patch there looks out
        looks_out = open_ < CODES
        return (
            face.origin,
            going & face.valid & (~face.free | looks_out),
            face.free,
            open_,
            seen,
            depth + dr.select(emit, UInt32(1), 0),
        )

    outside = dr.select(within, first, UInt32(ESCAPED))
    state = (
        types.Array3f(origin), lane < dr.opaque(UInt32, lines), dr.full(Bool, False, dr.width(index)), outside, outside,
        dr.zeros(UInt32, dr.width(index)),
    )  # fmt: skip
    depth = dr.while_loop(state, lambda origin, going, *rest: going, body, mode="symbolic")[-1]
    dr.eval(depth, counter, records)
    begins = dr.prefix_sum(depth)
    dr.eval(begins)
    return begins, int(counter[0])


def _resolved(one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What is seen through backs that let lines pass: what the next span of the line ends on, seen from one side only."""
    pending = other == PENDING
    if pending.any():
        at = np.where(pending, len(other), np.arange(len(other)))
        after = np.minimum.accumulate(at[::-1])[::-1]
        seen = other[after]
        other = np.where(pending, np.where(seen < CODES, seen | np.uint32(ONE_WAY), seen), other)
    return one, other


assert LOST >= CODES
