"""Upper words of counters: kernels add to counters of 32 or 64 bits that wrap around, and the host notes how often they did.

A counter has passed half of its range an odd number of times where its highest bit is set. So from time to time, before any
counter can grow by half of its range, the highest bits tell which ones have passed a half since the last look. Nothing else
changes: kernels, their additions and the low words are those of counters that never wrap. The array of halves is made when a
counter comes near the end of its range for the first time.
"""

from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import frozen, upload

PERIOD = 1 << 29  # lines between two looks: of one line a counter of 32 bits grows by 1, of 64 bits by 2^31 at most


class Wraps:
    """The upper words of an array of counters, which the caller has and gives.

    Attributes:
        bits: of a counter, 32 or 64.
        halves: UInt32, how many halves of its range each counter had passed at the last look; None where none has been near.
    """

    def __init__(self, types: Any, bits: int = 32):
        self.types, self.bits = types, bits
        self.halves: Any = None

    def look(self, low) -> None:
        """Note which counters have passed a half of their range; called before any has grown by a half since the last call."""
        if self.halves is None:
            largest = dr.max(low)
            if int(frozen(largest)[0]) >> (self.bits - 2) == 0:
                return
            self.halves = self.types.UInt32(low >> (self.bits - 1))
        else:
            self.halves = self.halves + self._passed(low, self.halves)
        dr.eval(self.halves)

    def _passed(self, low, halves):
        return (self.types.UInt32(low >> (self.bits - 1)) ^ halves) & 1

    def upper(self, low, at=None):
        """Return the upper words of counters whose values are ``low`` now, UInt32; called in a kernel.

        Args:
            at: their places, or None for all of them.
        """
        if self.halves is None:
            return dr.zeros(self.types.UInt32, dr.width(low))
        halves = self.halves if at is None else dr.gather(self.types.UInt32, self.halves, at)
        return (halves + self._passed(low, halves)) >> 1

    def whole(self, low, at=None):
        """Return the values of counters of 32 bits, UInt64; called in a kernel."""
        wide = self.types.UInt64(low)
        return wide if self.halves is None else wide | (self.types.UInt64(self.upper(low, at)) << 32)

    def about(self, low, at=None):
        """Return the values of counters in double precision; called in a kernel."""
        value = self.types.Float64(low)
        return value if self.halves is None else value + self.types.Float64(self.upper(low, at)) * 2.0**self.bits

    @property
    def largest(self) -> int:
        """The largest upper word at the last look."""
        return 0 if self.halves is None else int(frozen(dr.max(self.halves))[0]) >> 1

    def read(self, low) -> np.ndarray | None:
        """Return the upper words of all counters on the host, uint32; None where none has wrapped around."""
        if self.halves is None:
            return None
        found = frozen(self.upper(low))
        return found if found.any() else None

    def values(self, low) -> np.ndarray:
        """Return the values of counters of 32 bits on the host: uint32 where these suffice, else uint64."""
        upper = self.read(low)
        return frozen(low) if upper is None else frozen(low) | (upper.astype(np.uint64) << np.uint64(32))

    def of(self, values: np.ndarray, upper: np.ndarray | None = None) -> np.ndarray:
        """Set the upper words to those of values on the host, and return the low words, flat.

        Args:
            values: of counters; or their low words, and then ``upper`` has the upper ones, or None where all are zero.
        """
        values = np.ravel(values)
        if self.bits == 32 and values.dtype.itemsize > 4:
            upper, values = values.astype(np.uint64) >> np.uint64(32), values.astype(np.uint32)
        self.halves = None
        near = bool((values >> values.dtype.type(self.bits - 2)).any())
        if near or (upper is not None and upper.any()):
            halves = (values >> values.dtype.type(self.bits - 1)).astype(np.uint32)
            halves += np.uint32(0) if upper is None else (np.ravel(upper) << 1).astype(np.uint32)
            self.halves = upload(self.types.UInt32, halves)
        return values
