"""Digital sequences in base 5 with any matrices, by a table for every five digits of the index.

The digits of point n's coordinate in dimension d are the digits of n times the matrix C_d modulo 5 (H. Niederreiter,
"Point sets and sequences with small discrepancy", Monatshefte für Mathematik 104, 1987). Digits have four bits each, eight of
them in a word, and all digits of a word are added and reduced at once.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from .base import DIMENSIONS, KRONECKER, LARGEST, AbstractNumbers

BASE = 5
ROWS, COLUMNS = 12, 15  # 5^-12 is far below a float's last place; 5^14 > 2^32
BLOCK = 5  # digits of the index that are looked up together
STEPS = (23, 32)  # 2^23 < 5^10
BELOW_ONE = 1 - 2.0**-24


@dataclass(frozen=True)
class Quinary(AbstractNumbers):
    """A digital sequence in base 5 with a digital shift: the randomisation's digits are added to those of the coordinates.

    Line ``index`` takes point index - 1, so that the first 5^m lines are a net. An entry, and the randomisation, has eight words:
    the first eight digits of coordinates 1 to 4; the last four digits of 1 and 2, and of 3 and 4; the first eight of 5, and its
    last four in the upper half.

    Attributes:
        matrices: a module's function that gives (5, 12, 15) digits, rows from the most significant digit of the coordinate
            on, columns from the least significant digit of the index on.
    """

    matrices: Callable[[], np.ndarray]

    def randomisation(self, stream: np.random.SeedSequence) -> np.ndarray:
        return packed(np.random.Generator(np.random.Philox(stream)).integers(0, BASE, (DIMENSIONS, ROWS)))

    def of_patch(self, randomisation, place):
        """Move the first four digits of each coordinate, by multiples of 1/625."""
        moved = list(randomisation)
        for word, step in zip((0, 1, 2, 3, 6), KRONECKER, strict=True):
            total = moved[word] + first_digits(place * step)
            moved[word] = total - _fives(total + 0x33333333)
        return moved

    def prepare(self, types):
        _table(self.matrices, types.UInt32)

    def points(self, index, patch, randomisation, bits):
        Float: Any = dr.float32_array_t(type(index))
        values = [
            dr.fma(Float(low), 1 / BASE**12, Float(high) * (1 / BASE**8)) for high, low in self.digits(index, randomisation, bits)
        ]
        return [dr.minimum(value, BELOW_ONE) for value in values]

    def digits(self, index, randomisation, bits: int) -> list[tuple]:
        """Return the first eight and the next four digits of five coordinates, as whole numbers below 5^8 and 5^4."""
        UInt32 = type(index)
        Array4u, table = _table(self.matrices, UInt32)
        n = index - 1
        quotient = n // BASE**BLOCK
        blocks = [n - quotient * BASE**BLOCK, quotient]
        if bits > STEPS[0]:
            blocks[1:] = [quotient - quotient // BASE**BLOCK * BASE**BLOCK, quotient // BASE**BLOCK]
        total = [UInt32(word) for word in randomisation]
        for i, block in enumerate(blocks):
            at = (block + i * BASE**BLOCK) * 2
            entry = [*dr.gather(Array4u, table, at), *dr.gather(Array4u, table, at + 1)]
            total = [word + more for word, more in zip(total, entry, strict=True)]
            if i:  # up to twelve so far, or eleven: less than eight hereafter
                total = [word - _fives(word) for word in total]
        words = [_halves(word - _fives(word + 0x33333333)) for word in total]
        high = [word - (word >> 16) * (2**16 - BASE**4) for word in (*words[:4], words[6])]
        low = [words[4] >> 16, words[4] & 0xFFFF, words[5] >> 16, words[5] & 0xFFFF, words[7] >> 16]
        return list(zip(high, low, strict=True))

    def steps(self):
        return STEPS

    def largest(self):
        return LARGEST


def _fives(word):
    """Return five in each digit whose highest bit is set, which is eight or more."""
    high = word & 0x88888888
    return (high >> 1) + (high >> 3)


def _halves(word):
    """Turn four digits into a whole number below 5^4, in both halves of a word."""
    word = word - ((word >> 4) & 0x0F0F0F0F) * (16 - BASE)
    return word - ((word >> 8) & 0x00FF00FF) * (256 - BASE**2)


def first_digits(word):
    """Return the first four digits of ``word`` / 2^32, UInt32, at the upper end, four bits each."""
    four: Any = dr.mul_hi(word, type(word)(BASE**4))
    two = (four * 1311) >> 15  # the quotient by 25
    pairs = (two << 16) | (four - two * BASE**2)
    upper = ((pairs * 13) >> 6) & 0x00070007  # by 5
    digits = (upper << 4) | (pairs - upper * BASE)
    return ((digits & 0x00FF0000) << 8) | ((digits & 0xFF) << 16)


def packed(digits: np.ndarray) -> np.ndarray:
    """Return the words of entries, (..., 8) uint32, see `Quinary`, from digits, (..., 5, 12)."""
    digits = digits.astype(np.uint32)
    high = (digits[..., :8] << np.arange(28, -1, -4, dtype=np.uint32)).sum(axis=-1, dtype=np.uint32)
    low = (digits[..., 8:] << np.arange(12, -1, -4, dtype=np.uint32)).sum(axis=-1, dtype=np.uint32)
    pairs = [low[..., 0] << 16 | low[..., 1], low[..., 2] << 16 | low[..., 3]]
    return np.stack([*np.moveaxis(high[..., :4], -1, 0), *pairs, high[..., 4], low[..., 4] << 16], axis=-1).astype(np.uint32)


def table(matrices: np.ndarray) -> np.ndarray:
    """Return the words of five coordinates for each five digits of an index and each of their values, (3, 3125, 8) uint32.

    Args:
        matrices: (5, 12, 15), see `Quinary`.
    """
    digits = np.arange(BASE**BLOCK)[:, None] // BASE ** np.arange(BLOCK) % BASE
    columns = matrices.astype(np.int64).reshape(DIMENSIONS, ROWS, COLUMNS // BLOCK, BLOCK)
    return packed(np.einsum("vc,drbc->bvdr", digits, columns) % BASE)


@cache
def _table(matrices: Callable[[], np.ndarray], UInt32):
    """Return a type of four words, and `table` on the device."""
    return import_module(UInt32.__module__).Array4u, upload(UInt32, table(matrices()))
