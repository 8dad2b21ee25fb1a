"""The Halton sequence with its digits permuted, in bases 2, 3, 5, 7, 11.

The permutations are those of H. Faure, "Good permutations for extreme discrepancy", J. Number Theory 42, 1992: one for each base,
and 0 stays 0. They change nothing in bases 2 and 3. In the larger bases, whose first points lie on a line, they separate them.

RenderPark adds instead, up to the leading digit, the digit's place m = 0, 1, ... to each digit, modulo the base. That is not used
here: in base 2 its numbers 1 and 3 are equal, and without the limit at the leading digit it would be one digital shift.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from .base import LARGEST, WORDS, AbstractNumbers
from .halton import BASES, binary, moved, radical_inverse, shifts

BLOCKS = {5: (5, 5, 4), 7: (4, 4, 4), 11: (4, 3, 3)}  # digits of the index that are looked up together
STEPS = (14, 16, 19, 22, 32)  # 2^22 < 7^8: up to here two blocks are enough


@dataclass(frozen=True)
class ScrambledHalton(AbstractNumbers):
    """The scrambled Halton sequence: each coordinate is moved by a seeded shift modulo 1 (Cranley and Patterson 1976)."""

    def randomisation(self, stream: np.random.SeedSequence) -> np.ndarray:
        return np.random.Generator(np.random.Philox(stream)).integers(0, 2**32, WORDS, dtype=np.uint32)

    def prepare(self, types):
        for base in BLOCKS:
            _table(base, types.UInt32)

    def points(self, index, patch, randomisation, bits):
        inverses = [radical_inverse(index, 3, bits), *(scrambled(index, base, bits) for base in BASES[2:])]
        return moved([binary(index), *inverses], shifts(randomisation))

    def steps(self):
        return STEPS

    def largest(self):
        return LARGEST


def scrambled(index, base: int, bits: int):
    """Return the digits of ``index`` (UInt32, below 2**bits) in ``base``, permuted and mirrored; Float32 in [0, 1]."""
    Float: Any = dr.float32_array_t(type(index))
    parts, place, start = [], 1, 0
    for digits in BLOCKS[base]:
        if place >= 2**bits:
            break
        quotient = index // base**digits
        entry = index - quotient * base**digits + start
        parts.append((place * base**digits, dr.gather(Float, _table(base, type(index)), entry)))
        index, place, start = quotient, place * base**digits, start + base**digits
    value = Float(0)
    for place, part in reversed(parts):
        value = dr.fma(part, 1.0 / place, value)
    return value


def permutation(base: int) -> list[int]:
    """Return Faure's permutation: for even bases two halves interleave; for odd ones the base below gets a new middle."""
    if base == 2:
        return [0, 1]
    if base % 2 == 0:
        half = permutation(base // 2)
        return [2 * p for p in half] + [2 * p + 1 for p in half]
    middle = (base - 1) // 2
    below = [p + (p >= middle) for p in permutation(base - 1)]
    return [*below[:middle], middle, *below[middle:]]


@cache
def _table(base: int, UInt32):
    """Return permuted and mirrored digits of each block's values as whole numbers, one block after the other."""
    tables = []
    for digits in BLOCKS[base]:
        rest, mirrored = np.arange(base**digits), np.zeros(base**digits, np.int64)
        for _ in range(digits):
            rest, mirrored = rest // base, mirrored * base + np.array(permutation(base))[rest % base]
        tables.append(mirrored)
    return upload(dr.float32_array_t(UInt32), np.concatenate(tables).astype(np.float32))
