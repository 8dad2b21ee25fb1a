"""Stored lines: where the first cosine lines of each patch hit, and with a basis also where they begin and end on patches."""

from typing import Any

import drjit as dr

from ...patches.bases import CONSTANT, Basis
from ...tracing.spots import Spot
from .packets import Packets

HALF = 15  # bits of a coordinate: what is lost is small beside what a few lines say
LARGEST = (1 << HALF) - 1
IS_QUAD = 1 << (2 * HALF)  # the patch is a parallelogram


class StoredLines:
    """Line k of a lane is at (k - first) * lanes + lane.

    Attributes:
        packets: the lanes.
        basis: of the light on patches.
        hits: UInt32, the place of the patch that a line hits, or `packets.ESCAPED` or `LOST`.
        ends: UInt32 each, coordinates of where a line begins and ends on its patches; none where the basis is constant.
        count: for how many lines of a lane there is room.
        before: UInt32, how many lines of all lanes come before the first that is kept; None where that is line 0.
    """

    def __init__(self, packets: Packets, basis: Basis = CONSTANT, count: int = 0, first: int = 0):
        self.packets, self.basis, self.count = packets, basis, 0
        self.before = dr.opaque(packets.types.UInt32, first * packets.lanes % (1 << 32)) if first else None
        self.hits: Any = dr.zeros(packets.types.UInt32, packets.lanes)
        self.ends: list = [dr.zeros(packets.types.UInt32, packets.lanes) for _ in range(2 if basis.size > 1 else 0)]
        self.make_room(count)

    def make_room(self, count: int) -> None:
        """Make room for so many lines of each lane."""
        more = (count - self.count) * self.packets.lanes
        if more > 0:
            self.hits = self._longer(self.hits, more)
            self.ends = [self._longer(one, more) for one in self.ends]
            self.count = count

    def _longer(self, one: Any, more: int) -> Any:
        room = dr.zeros(self.packets.types.UInt32, more)
        return dr.concat([one, room]) if self.count else room

    def keep(self, at, where, begin: Spot | None, end: Spot | None) -> None:
        """Take lines whose number in all lanes is ``at``, modulo 2^32; called in a kernel."""
        at = at if self.before is None else at - self.before
        dr.scatter(self.hits, where, at)
        if self.ends and begin is not None and end is not None:
            on = where < self.packets.read_width
            dr.scatter(self.ends[0], self._packed(begin), at)
            dr.scatter(self.ends[1], dr.select(on, self._packed(end), 0), at)

    def spots(self, at) -> tuple[Spot, Spot]:
        """Return where lines begin and end; called in a kernel."""
        one, other = (self._unpacked(dr.gather(self.packets.types.UInt32, words, at)) for words in self.ends)
        return one, other

    def arrays(self) -> list:
        """The arrays that kernels write to."""
        return [self.hits, *self.ends]

    def _packed(self, spot: Spot):
        kind = self.packets.types.UInt32
        a, b = (kind(dr.round(x * float(LARGEST))) for x in (spot.a, spot.b))
        quad = kind(IS_QUAD) if spot.quad is True else dr.select(spot.quad, kind(IS_QUAD), kind(0))
        return a | b << HALF | quad

    def _unpacked(self, word) -> Spot:
        a, b = (self.packets.types.Float(x & LARGEST) * (1.0 / LARGEST) for x in (word, word >> HALF))
        return Spot(a, b, True if self.packets.geometry.all_quads else (word & IS_QUAD) != 0)
