"""The Halton sequence in as many dimensions as a walk needs: each number of each segment has a prime base of its own.

A. Keller makes walks so ("Quasi-Monte Carlo radiosity", 7th Eurographics Workshop on Rendering, 1996): walk n is point n of one
sequence. The first segment takes the bases 2, 3, 5, 7, 11, see `halton`, and each later one the next primes, as many as it needs
numbers. With each segment the bases are larger. Two of them, b and c, need b c walks to fill their square once.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from .base import DIMENSIONS
from .halton import BASES
from .shuffle import key, shuffled

COUNT = 8192  # primes in the table, the largest is 84 067: walks of 4096 segments of two numbers
DIGITS = 7  # of an index that count: 13^-7 is below 2^-25


@dataclass(frozen=True)
class PrimeBases:
    """The numbers of the later segments of a walk.

    Attributes:
        dimensions: those of the five dimensions that a segment uses, see `AbstractNumbers`; the others are zero.
        table: UInt32, the primes behind those of the first segment.
    """

    dimensions: tuple[int, ...]
    table: Any

    @staticmethod
    def of(types: Any, dimensions: tuple[int, ...]) -> "PrimeBases":
        """Put the primes on the device of Dr.Jit's array ``types``."""
        return PrimeBases(dimensions, _table(types.UInt32))

    def points(self, index, segment, randomisation) -> list:
        """Return five Dr.Jit floats in [0, 1); called in a kernel.

        They are the radical inverses of the index in primes of the segment, each moved modulo 1 by a shift. Where a walk has
        more segments than the table has primes for, the table begins again, with indices in another order.

        Args:
            index: UInt32, the number of the walk, from 1.
            segment: UInt32, 1 and up: how often the walk was reflected before.
            randomisation: eight UInt32 of the segment, whose first words are the shifts.
        """
        Float: Any = dr.float32_array_t(type(index))
        needed = len(self.dimensions)
        turn = (segment - 1) // (COUNT // needed)
        at = (segment - 1 - turn * (COUNT // needed)) * needed
        index = dr.select(turn == 0, index, shuffled(index, key(randomisation, segment)))
        result = [Float(0)] * DIMENSIONS
        for place, dimension in enumerate(self.dimensions):
            base = dr.gather(type(index), self.table, at + place)
            value = radical_inverse(index, base) + Float(randomisation[dimension] >> 8) * 2.0**-24
            result[dimension] = value - dr.floor(value)
        return result


def radical_inverse(index, base):
    """Return the digits of an index (UInt32) in a base (UInt32, 13 and above), mirrored at the point; Float32 in [0, 1].

    Quotients are computed in double precision, where they are exact, since half a step over the base is more than rounding. A
    division of whole numbers would end the process in lanes that have no base.
    """
    Float: Any = dr.float32_array_t(type(index))
    Double: Any = dr.float64_array_t(type(index))
    number, base, digits = Double(index), Double(base), []
    step = 1 / base
    for _ in range(DIGITS):
        quotient = dr.floor((number + 0.5) * step)
        digits.append(dr.fma(quotient, -base, number))
        number = quotient
    value = Double(0)
    for digit in reversed(digits):
        value = (value + digit) * step
    return Float(value)


def primes(count: int) -> np.ndarray:
    """Return the first primes behind those of `halton.BASES`, (count,) uint32 (Eratosthenes' sieve)."""
    below = 1 << 8
    while True:
        prime = np.ones(below, bool)
        prime[:2] = False
        for number in range(2, int(below**0.5) + 1):
            if prime[number]:
                prime[number * number :: number] = False
        found = np.flatnonzero(prime)[len(BASES) :]
        if len(found) >= count:
            return found[:count].astype(np.uint32)
        below *= 2


@cache
def _table(UInt32):
    return upload(UInt32, primes(COUNT))
