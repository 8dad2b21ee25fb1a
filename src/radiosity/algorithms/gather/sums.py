"""Sums of what lines bring to lanes, in 64-bit fixed point, which go on beyond 64 bits.

Upper parts are set apart only where a lane has more than 2^32 lines: up to there the sums fit.
"""

from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from .packets import Packets

BITS = 32
LOW = (1 << BITS) - 1


class Sums:
    """A sum for each lane and column: a group of bands, or a coefficient of one.

    Attributes:
        kind: the type of the words, UInt64, or Int64 where sums may be negative.
        low: of each column, words that lines are added to.
        high: of each column, Int64, what was set apart, in units of 2^32; None where nothing was.
    """

    def __init__(self, packets: Packets, kind: Any, columns: int):
        self.packets, self.kind = packets, kind
        self.low: list = [dr.zeros(kind, packets.lanes) for _ in range(columns)]
        self.high: list | None = None

    def add(self, more: list) -> None:
        """Add whole numbers of each column."""
        self.low = [total + self.kind(value) for total, value in zip(self.low, more, strict=True)]

    def set_apart(self) -> None:
        """Move the upper parts of all words to ``high``."""
        wide = self.packets.types.Int64
        high = self.high or [dr.zeros(wide, self.packets.lanes) for _ in self.low]
        self.high = [above + wide(word >> BITS) for above, word in zip(high, self.low, strict=True)]
        self.low = [word & LOW for word in self.low]
        dr.eval(self.low, self.high)

    def about(self) -> list:
        """Return the sums of each column, Float64. They do not depend on what was set apart."""
        types = self.packets.types
        wide = types.Float64
        if self.high is None:
            return [wide(word) for word in self.low]
        pairs = zip(self.low, self.high, strict=True)
        return [wide(above + types.Int64(word >> BITS)) * 2.0**BITS + wide(word & LOW) for word, above in pairs]

    def copy(self) -> "Sums":
        """Return sums that can be added to apart."""
        other = Sums.__new__(Sums)
        other.packets, other.kind, other.low, other.high = self.packets, self.kind, list(self.low), self.high
        return other

    def read(self) -> tuple[np.ndarray, np.ndarray | None]:
        """Return words, (replicates, n_patches, columns), and the words above them where there are any (see `Record.about`)."""
        low = self._stacked(self.low)
        if self.high is None:
            return low, None
        high = self._stacked(self.high) + (low >> low.dtype.type(BITS)).astype(np.int64)
        words = (high.astype(np.uint64) << np.uint64(BITS)) | (low.astype(np.uint64) & np.uint64(LOW))
        return words, high >> BITS

    def write(self, words: np.ndarray, upper: np.ndarray | None) -> None:
        """Set the sums to what `read` returned."""
        if upper is None:
            self.low, self.high = self._lanes(self.kind, words), None
            return
        high = (words >> np.uint64(BITS)).astype(np.int64) + (upper.astype(np.int64) << BITS)
        self.low = self._lanes(self.kind, words & np.uint64(LOW))
        self.high = self._lanes(self.packets.types.Int64, high)

    def _stacked(self, columns: list) -> np.ndarray:
        return np.stack([self.packets.patch_values(frozen(one)) for one in columns], axis=-1)

    def _lanes(self, kind: Any, values: np.ndarray) -> list:
        return [upload(kind, self.packets.lane_values(values[..., column])) for column in range(values.shape[-1])]
