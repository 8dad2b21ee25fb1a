"""Spans that exchange power one after the other: the sequential part of multipath.

A span between i and j carries from each to the other what it has not sent yet, and what it emits at each span end. The receiver
keeps what it reflects for its next span. The order of spans is part of the method, so a lane follows all spans of a replicate;
lanes run in parallel.

Dr.Jit lets a loop's body access an array that it also changes only once, by an atomic exchange. So a span takes three steps, at
i, at j and at i again: each step puts in what the step before took out, and takes out what is there.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...device.recorded import loop
from ...tally.wraps import Wraps
from ...tracing.global_lines.crossing import CODES, ESCAPED, ONE_WAY

LEDGER = ("fired", "reflected", "escaped", "lost")


@dataclass(eq=False)
class Exchange:
    """Powers of one group of bands, in fixed point: whole units in 64 bits.

    Attributes:
        types: Dr.Jit's array types.
        one_ways: True where some spans are seen from one end only.
        rho: UInt32 (n_patches,), reflectance times 2^32.
        source: UInt64 (replicates * n_patches), what a patch emits along each span.
        unshot: UInt64, the same size: what it has reflected since its last span.
        landed: UInt64, the same size: all that arrived, modulo 2^64; ``upper`` has the upper words.
    """

    types: Any
    one_ways: bool
    rho: Any
    source: Any
    unshot: Any
    landed: Any
    upper: Wraps

    def run(self, one: Any, other: Any, lengths: np.ndarray, n_patches: int) -> np.ndarray:
        """Go through the spans of each replicate.

        Args:
            one, other: UInt32, ends as in `Pairs`, first all spans of one replicate, then those of the next.
            lengths: (replicates,) the number of spans of each.

        Returns:
            Power that left, was reflected, escaped and was lost (LEDGER), (4, replicates) uint64.
        """
        types = self.types
        UInt32, UInt64 = types.UInt32, types.UInt64
        lanes = max(len(lengths), 2)
        ends = np.zeros((2, lanes), np.uint32)
        ends[1, : len(lengths)] = np.cumsum(lengths)
        ends[0, 1 : len(lengths)] = np.cumsum(lengths)[:-1]
        span, end = (upload(UInt32, row) for row in ends)
        row = dr.arange(UInt32, lanes) * dr.opaque(UInt32, n_patches)

        def body(span, step, carried, fired, reflected, escaped, lost):
            i, j = dr.gather(UInt32, one, span), dr.gather(UInt32, other, span)
            at = dr.select(step == 1, j, i)
            single = types.Bool(False)
            if self.one_ways:
                single = (j >= ONE_WAY) & (j < CODES) & (step > 0)
                at = dr.select(single, j & (ONE_WAY - 1), at)
            patch = at < ONE_WAY
            brought = carried if not self.one_ways else dr.select(single & (step == 2), 0, carried)
            escaped = escaped + dr.select(at == ESCAPED, brought, 0)
            lost = lost + dr.select(patch | (at == ESCAPED), 0, brought)
            kept = dr.select(patch, times(brought, UInt64(dr.gather(UInt32, self.rho, at, patch))), 0)
            reflected = reflected + kept
            dr.scatter_add(self.landed, brought, row + at, active=patch)
            left = kept
            if self.one_ways:  # j keeps what it has not sent yet: one step takes it out, the next puts it back with the new
                left = dr.select(single, dr.select(step == 1, 0, carried), left)
            taken = dr.scatter_exch(self.unshot, left, row + at, active=patch)
            sent = dr.select(patch, taken + dr.gather(UInt64, self.source, row + at, patch), 0)
            last = step == 2
            if self.one_ways:
                fired = fired + dr.select(last | single, 0, sent)
                sent = dr.select(single, taken + kept, sent)
            else:
                fired = fired + dr.select(last, 0, sent)
            return (
                dr.select(last, span + 1, span),
                dr.select(last, 0, step + 1),
                dr.select(last, 0, sent),
                fired,
                reflected,
                escaped,
                lost,
            )

        nothing = [dr.zeros(UInt64, lanes) for _ in range(5)]
        state = (span, dr.zeros(UInt32, lanes), *nothing)
        ledger = loop(state, lambda span, *rest: span < end, body)[3:]
        dr.eval(*ledger, self.unshot, self.landed)
        return np.stack([np.array(frozen(column))[: len(lengths)] for column in ledger])


def times(power, rho):
    """Return power (below 2^63) times a 32-bit fraction, rounded down, without overflow."""
    return (power >> 32) * rho + (((power & 0xFFFFFFFF) * rho) >> 32)
