"""One step of a line from face to face, and the span that it ends; called in a kernel.

The side of a face that looks forward begins a span, and the next side that looks backward ends it. Where backs let lines pass,
it may be that only one of two sides sees the other: it looks through a back whose front hides it from the other.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from .crossing import CODES, NOBODY, ONE_WAY, PENDING, Crossings

WIDE = 64  # entries of a counter: arrays of one entry compile kernels of their own


@dataclass(eq=False)
class Sink:
    """Buffers for spans, in any order: (line, rank of the span on its line, one, other) each.

    Attributes:
        counter: UInt32, its first entry counts spans; also those for which there was no room.
        records: UInt32, ``capacity`` times four words.
        counts: UInt32, spans of each line.
    """

    counter: Any
    records: Any
    counts: Any
    limit: Any

    @staticmethod
    def of(types, capacity: int, lines: int) -> "Sink":
        UInt32 = types.UInt32
        return Sink(
            dr.opaque(UInt32, 0, WIDE),
            dr.opaque(UInt32, 0, 4 * capacity),
            dr.opaque(UInt32, 0, lines),
            dr.opaque(UInt32, capacity),
        )


def step(crossings: Crossings, index, direction, state, sink: Sink, coherent: bool):
    """Go on to the next face; called in a kernel.

    Args:
        index: UInt32, the lines' numbers.
        state: origin; going; blind: nothing lies ahead; begun: the side behind whose span has no end yet, NOBODY where a passing
            back hides it; seen: what is seen when looking back from here; and the number of spans so far.

    Returns:
        The state behind the face.
    """
    geometry = crossings.geometry
    types = geometry.device.types
    UInt32 = types.UInt32
    origin, going, blind, begun, seen, rank = state
    face = crossings.next(origin, direction, going & ~blind, coherent=coherent)
    one, other, emit = begun, face.near, (begun < CODES) | (face.near < CODES)
    if geometry.some_backs_pass:
        alone = begun == NOBODY  # of what lies behind, only what looks back from here matters
        through = alone & (seen < CODES)
        one, other = dr.select(through, face.near, dr.select(alone, seen, one)), dr.select(through, seen | ONE_WAY, other)
        emit = dr.select(alone, face.near < CODES, emit)
        # a back that lets lines pass: what looks on sees what its front will see
        other = dr.select(face.near_passes, UInt32(PENDING), other)
        emit = dr.select(face.near_passes, begun < CODES, emit)
    emit &= going
    slot = dr.scatter_inc(sink.counter, UInt32(0), active=emit)
    dr.scatter(sink.records, types.Array4u(index, rank, one, other), slot, active=emit & (slot < sink.limit))
    dr.scatter_add(sink.counts, UInt32(1), index, active=emit)
    begun, seen = face.far, dr.select(face.far_passes, seen, face.far)
    if geometry.some_backs_pass:
        begun = dr.select(face.far_passes, UInt32(NOBODY), begun)
    # behind the hull's faces there is nothing to trace; a patch there looks out
    going = going & face.valid & (~face.free | (begun < CODES))
    return face.origin, going, face.free, begun, seen, rank + dr.select(emit, UInt32(1), 0)
