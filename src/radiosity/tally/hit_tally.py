"""The addition of hits: a count, and the power of bands where these differ, are added to the slot of a patch.

Lines of many threads hit one slot. Either all additions are atomic, or each thread adds to a copy of its own, and the copies are
summed in the end. Copies are faster where many lines hit a slot, and take memory.
"""

from abc import ABC, abstractmethod
from typing import Any

import drjit as dr

SHARED = 2  # lines a counter, above which copies are faster
DENSE = 4  # lines a counter, above which atomic additions wait for each other: a GPU then adds in other ways
MOST = 6 << 20  # largest size of a copy, in bytes: larger ones gain little
WORDS = 4  # words of a packet of counts and powers


class AbstractHitTally(ABC):
    """Adds the hits of the lines of a wavefront, which may take several launches."""

    @abstractmethod
    def add(self, slot, powers: list, active) -> None:
        """Add a hit to each slot, with a power of each group of bands (no powers where there is one group).

        Called in a kernel.
        """

    @abstractmethod
    def arrays(self) -> list:
        """The arrays that a launch evaluates."""

    @abstractmethod
    def settle(self) -> None:
        """Add what is still apart to the hit counts; called after the last launch."""


class Atomic(AbstractHitTally):
    """Adds hits to the hit counts at once. With ``flags`` it marks the slots that lines hit."""

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
    """Adds hits to one copy for each thread of a CPU.

    Dr.Jit adds packets of two or four words one lane after the other. It compares a single word with those of all other lanes
    first, to add equal places once, which takes two to eight times as long. So a count is added together with a second word
    that stays zero, or with the powers of three groups of bands.
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
    """The arrays that hits are added to."""
    return [hits.arrivals, hits.touched, *([] if hits.bands is None else [hits.bands.received])]


def groups_of(hits) -> int:
    """The number of groups of bands whose power lines carry; 0 where there is one group."""
    return 0 if hits.bands is None else hits.bands.n


def packets(groups: int) -> int:
    """The number of packets of a slot, for a count and the powers of ``groups`` groups."""
    return -(-(1 + groups) // WORDS)


def hit_tally(hits, lines: int, flags: bool) -> AbstractHitTally:
    """Return the faster hit tally for a wavefront of ``lines`` lines."""
    groups = groups_of(hits)
    each = 2 * 4 if groups == 0 else packets(groups) * WORDS * 8  # bytes
    checked = dr.flag(dr.JitFlag.Debug)  # debug mode takes packets in the second thread's copy for out of bounds, and skips them
    if hits.tracer.geometry.device.name != "cpu" or checked:
        return Atomic(hits, flags, dr.ReduceMode.Expand if lines > DENSE * hits.tracer.total else dr.ReduceMode.Direct)
    copies = lines > SHARED * hits.tracer.total and each * hits.tracer.total <= MOST
    return Copied(hits, flags) if copies else Atomic(hits, flags)
