"""Where lines land: a count, and the power of bands where these differ, are added to the slot of a patch.

Lines of many threads land in one slot. Either all additions are atomic, or each thread adds to copies of its own, which are
summed in the end: that pays where many lines come to a slot, and takes memory for the copies.
"""

from abc import ABC, abstractmethod
from typing import Any

import drjit as dr

SHARED = 2  # more lines a counter than this: copies pay
DENSE = 4  # and than this: nearly all patches are landed on, and flags are not worth while
MOST = 6 << 20  # bytes of a copy: larger ones gain little
WORDS = 4  # of a packet of counts and powers


class AbstractHitTally(ABC):
    """Of the lines of a sweep, which may take several launches."""

    @abstractmethod
    def add(self, slot, powers: list, active) -> None:
        """In a kernel: lines land in slots, with a power of each group of bands (none where there is one)."""

    @abstractmethod
    def arrays(self) -> list:
        """What a launch evaluates."""

    @abstractmethod
    def settle(self) -> None:
        """After the last launch: all is in the hit counts."""


class Atomic(AbstractHitTally):
    """Added to the hit counts at once. With ``flags`` it is remembered where lines landed."""

    def __init__(self, hits, flags: bool, mode: dr.ReduceMode = dr.ReduceMode.Direct):
        self.hits, self.flags, self.mode = hits, flags, mode

    def add(self, slot, powers, active):
        hits, types = self.hits, self.hits.tracer.types
        dr.scatter_add(hits.arrivals, types.UInt32(1), slot, active=active, mode=self.mode)
        if self.flags:
            dr.scatter(hits.touched, types.Bool(True), slot, active=active)
        for g, power in enumerate(powers):
            dr.scatter_add(hits.bands.received, power, slot * len(powers) + g, active=active, mode=self.mode)

    def arrays(self):
        return counters(self.hits)

    def settle(self):
        pass


class Copied(AbstractHitTally):
    """Added to a copy of each thread, on a CPU.

    Dr.Jit adds packets of two or four words one lane after the other. Single words it compares with those of all other lanes
    first, to add equal places once, which takes two to eight times as long. So a count goes with a second word that stays
    zero, or with the powers of three groups of bands.
    """

    def __init__(self, hits, flags: bool):
        self.hits, self.flags, types = hits, flags, hits.tracer.types
        self.n = groups_of(hits)
        self.packet: Any = types.Array2u if self.n == 0 else types.Array4u64
        self.size, self.rows = dr.size_v(self.packet), packets(self.n)
        self.sums = dr.opaque(dr.value_t(self.packet), 0, dr.width(hits.arrivals) * self.rows * self.size)

    def add(self, slot, powers, active):
        words = [1, *powers, *[0] * (self.rows * self.size - 1 - len(powers))]
        for row in range(self.rows):
            packet = self.packet(*words[row * self.size : (row + 1) * self.size])
            dr.scatter_add(self.sums, packet, slot * self.rows + row, active=active, mode=dr.ReduceMode.Expand)

    def arrays(self):
        return [self.sums]

    def settle(self):
        hits, types = self.hits, self.hits.tracer.types
        slot = dr.arange(types.UInt32, dr.width(hits.arrivals))
        words = [w for row in range(self.rows) for w in dr.gather(self.packet, self.sums, slot * self.rows + row)]
        hits.arrivals = hits.arrivals + types.UInt32(words[0])
        if self.flags:
            hits.touched = hits.touched | (words[0] != 0)
        for g, power in enumerate(words[1 : 1 + self.n]):
            dr.scatter_add(hits.bands.received, power, slot * self.n + g, mode=dr.ReduceMode.NoConflicts)
        dr.eval(*counters(hits))


def counters(hits) -> list:
    """What lines land in."""
    return [hits.arrivals, hits.touched, *([] if hits.bands is None else [hits.bands.received])]


def groups_of(hits) -> int:
    """Groups of bands whose power lines carry; none where there is one."""
    return 0 if hits.bands is None else hits.bands.n


def packets(groups: int) -> int:
    """Of a slot: of a count and the powers of so many groups."""
    return -(-(1 + groups) // WORDS)


def hit_tally(hits, lines: int, flags: bool) -> AbstractHitTally:
    """For a sweep of so many lines."""
    groups = groups_of(hits)
    each = 2 * 4 if groups == 0 else packets(groups) * WORDS * 8  # bytes
    checked = dr.flag(dr.JitFlag.Debug)  # it takes packets in the second thread's copy for out of bounds, and leaves them out
    if hits.tracer.geometry.device.name != "cpu" or checked:
        return Atomic(hits, flags, dr.ReduceMode.Expand if lines > DENSE * hits.tracer.total else dr.ReduceMode.Direct)
    copies = lines > SHARED * hits.tracer.total and each * hits.tracer.total <= MOST
    return Copied(hits, flags) if copies else Atomic(hits, flags)
