"""Digital sequences in base 2 with any matrices, by a table for each byte of the index.

The binary digits of point n's coordinate in dimension d are the digits of n times the matrix C_d modulo 2 (H. Niederreiter,
"Point sets and sequences with small discrepancy", Monatshefte für Mathematik 104, 1987). That is linear: the words of the four
bytes of n are looked up and added, which is an exclusive or.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from .base import DIMENSIONS, LARGEST, WORDS, AbstractNumbers

DIGITS = 32
STEPS = (16, 24, 32)  # whole bytes


@dataclass(frozen=True)
class Binary(AbstractNumbers):
    """A digital sequence in base 2 with a digital shift: the randomisation's words are added to those of the coordinates.

    Line ``index`` takes point index - 1, so that the first 2^m lines are a net (A. B. Owen, "On dropping the first Sobol' point",
    MCQMC 2020); the shift moves point 0 away from the corner.

    Attributes:
        matrices: a module's function that gives (5, 32, 32) digits, rows from the most significant digit of the coordinate
            on, columns from the least significant digit of the index on.
    """

    matrices: Callable[[], np.ndarray]

    def randomisation(self, stream: np.random.SeedSequence) -> np.ndarray:
        return np.random.Generator(np.random.Philox(stream)).integers(0, 2**32, WORDS, dtype=np.uint32)

    def prepare(self, types):
        _tables(self.matrices, types.UInt32)

    def points(self, index, patch, randomisation, bits):
        Float: Any = dr.float32_array_t(type(index))
        return [Float(word >> 8) * 2.0**-24 for word in self.words(index, randomisation, bits)]

    def words(self, index, randomisation, bits: int) -> list:
        """Return five UInt32: the coordinates times 2^32, of which `points` keeps the first 24 bits."""
        UInt32 = type(index)
        Array4u, four, fifth = _tables(self.matrices, UInt32)
        words = [UInt32(word) for word in randomisation[:DIMENSIONS]]
        n = index - 1
        for byte in range((bits + 7) // 8):
            entry = ((n >> (8 * byte)) & 0xFF) + 256 * byte
            added = [*dr.gather(Array4u, four, entry), dr.gather(UInt32, fifth, entry)]
            words = [word ^ more for word, more in zip(words, added, strict=True)]
        return words

    def steps(self):
        return STEPS

    def largest(self):
        return LARGEST


def table(matrices: np.ndarray) -> np.ndarray:
    """Return the words of five coordinates for each byte of an index and each of its values, (4, 256, 5) uint32.

    Args:
        matrices: (5, 32, 32), see `Binary`.
    """
    weights = 1 << np.arange(DIGITS - 1, -1, -1, dtype=np.uint64)
    columns = np.einsum("drc,r->cd", matrices.astype(np.uint64), weights).astype(np.uint32)
    values = np.arange(256)
    result = np.zeros((4, 256, DIMENSIONS), np.uint32)
    for bit in range(DIGITS):
        result[bit // 8] ^= np.where((values >> (bit % 8) & 1)[:, None], columns[bit], np.uint32(0)).astype(np.uint32)
    return result


@cache
def _tables(matrices: Callable[[], np.ndarray], UInt32):
    """Return a type of four words, and `table` on the device: dimensions 1 to 4 side by side for one read, and dimension 5."""
    values = table(matrices())
    four, fifth = upload(UInt32, values[:, :, :4]), upload(UInt32, values[:, :, 4])
    return import_module(UInt32.__module__).Array4u, four, fifth
