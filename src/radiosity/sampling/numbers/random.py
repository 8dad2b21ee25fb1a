"""Random numbers without state: Philox 4x32-10.

J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from .base import LARGEST, WORDS, AbstractNumbers

MULTIPLIERS = (0xD2511F53, 0xCD9E8D57)
WEYL = (0x9E3779B9, 0xBB67AE85)
ROUNDS = 10


@dataclass(frozen=True)
class Random(AbstractNumbers):
    """Random numbers whose counter is (index, patch); the key and the rest of the counter come from the seed and replicate."""

    def randomisation(self, stream: np.random.SeedSequence) -> np.ndarray:
        return stream.generate_state(WORDS, np.uint32)

    def of_patch(self, randomisation, place):
        return randomisation  # the patch is in the counter

    def prepare(self, types):
        pass  # reads nothing

    def points(self, index, patch, randomisation, bits):
        Float: Any = dr.float32_array_t(type(index))
        words = philox([index, patch, *randomisation[2:4]], randomisation[:2])
        more = philox([index, patch, *randomisation[6:8]], randomisation[4:6])
        return [Float(word >> 8) * 2.0**-24 for word in [*words, more[0]]]

    def steps(self):
        return (32,)

    def largest(self):
        return LARGEST


def philox(counter, key):
    """Return four UInt32 words from a counter of four words and a key of two."""
    UInt32 = type(counter[0])
    x, (k0, k1) = list(counter), (UInt32(key[0]), UInt32(key[1]))
    for _ in range(ROUNDS):
        low = [x[0] * MULTIPLIERS[0], x[2] * MULTIPLIERS[1]]
        high = [dr.mul_hi(x[0], UInt32(MULTIPLIERS[0])), dr.mul_hi(x[2], UInt32(MULTIPLIERS[1]))]
        x = [high[1] ^ x[1] ^ k0, low[1], high[0] ^ x[3] ^ k1, low[0]]
        k0, k1 = k0 + WEYL[0], k1 + WEYL[1]
    return x
