"""The Halton sequence (J. H. Halton, Numerische Mathematik 2, 1960) in bases 2, 3, 5, 7, 11."""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from .base import LARGEST, WORDS, AbstractNumbers

BASES = (2, 3, 5, 7, 11)
LOW_DIGITS = {3: 13, 5: 9, 7: 7, 11: 6}  # one pass: below base**digits < 2^22 quotients in single precision are exact
HIGH_DIGITS = {3: 8, 5: 5, 7: 5, 11: 4}  # a second pass for the rest of 32 bits
CHAIN = 3  # digits
STEPS = (14, 16, 19, 24, 32)  # 2^19 is less than the smallest base**digits of one pass


@dataclass(frozen=True)
class Halton(AbstractNumbers):
    """The Halton sequence: radical inverses, each moved by a seeded shift modulo 1 (Cranley and Patterson 1976)."""

    def randomisation(self, stream: np.random.SeedSequence) -> np.ndarray:
        return np.random.Generator(np.random.Philox(stream)).integers(0, 2**32, WORDS, dtype=np.uint32)

    def prepare(self, types):
        pass  # reads nothing

    def points(self, index, patch, randomisation, bits):
        inverses = [radical_inverse(index, base, bits) for base in BASES[1:]]
        return moved([binary(index), *inverses], shifts(randomisation))

    def in_turn(self, first, patch, randomisation, bits, turns):
        neighbours = [Neighbours.of(first, base, bits, turns) for base in BASES[1:]]

        def points(turn):
            index = first + turn
            return moved([binary(index), *(inverse.at(turn) for inverse in neighbours)], shifts(randomisation(index)))

        return points

    def steps(self):
        return STEPS

    def largest(self):
        return LARGEST


def _float_of(array) -> Any:
    """Return the type of single precision that goes with an array's type."""
    return dr.float32_array_t(type(array))


def shifts(randomisation) -> list:
    """Return the shift of each dimension, in [0, 1)."""
    return [_float_of(shift)(shift >> 8) * 2.0**-24 for shift in randomisation[: len(BASES)]]


def moved(point: list, by: list) -> list:
    """Return a point moved by a shift, modulo 1."""
    sums = [value + shift for value, shift in zip(point, by, strict=True)]
    return [value - dr.floor(value) for value in sums]


def binary(index):
    """Return the radical inverse in base 2, to 24 bits."""
    return _float_of(index)(dr.brev(index) >> 8) * 2.0**-24


def radical_inverse(index, base: int, bits: int):
    """Return the digits of ``index`` (UInt32, below 2**bits) in ``base``, mirrored at the point; Float32 in [0, 1].

    Quotients are computed in single precision, with four instructions a digit; larger indices are split once. The value
    depends on the index alone: fewer digits are scaled by an exact power before anything is rounded.
    """
    return _value(_mirrored(index, base, bits, 0), base)


@dataclass(frozen=True)
class Neighbours:
    """The radical inverses of consecutive indices, to the same bits.

    They differ in a few low digits and in one carry at most. So the other digits are mirrored only twice: without and with the
    carry.

    Attributes:
        base: of the digits.
        short: the number of low digits that differ.
        begin: the low digits of the first index, as a number.
        before, after: the other digits mirrored, see `_mirrored`: of the first index, and after a carry.
    """

    base: int
    short: int
    begin: Any
    before: list[Any]
    after: list[Any]

    @staticmethod
    def of(first, base: int, bits: int, turns: int) -> "Neighbours":
        """Make those of ``turns`` indices from ``first`` (UInt32) on."""
        short = next(digits for digits in range(1, turns + 1) if base**digits >= turns)
        quotient = first // base**short
        begin = _float_of(first)(first - quotient * base**short)
        return Neighbours(base, short, begin, *(_mirrored(q, base, bits, short) for q in (quotient, quotient + 1)))

    def at(self, turn):
        """Return the radical inverse of the index ``turn`` (UInt32) after the first."""
        period, unit = self.base**self.short, float(self.base ** (LOW_DIGITS[self.base] - self.short))
        digits = self.begin + type(self.begin)(turn)
        carried = digits >= period
        whole, *rest = (dr.select(carried, b, a) for a, b in zip(self.before, self.after, strict=True))
        low = _mirror_chains(dr.select(carried, digits - period, digits), self.base, self.short)
        return _value([dr.fma(low, unit, whole), *rest], self.base)


def _value(parts: list, base: int):
    return sum(parts[1:], parts[0]) * (1.0 / base ** LOW_DIGITS[base])


def _mirrored(index, base: int, bits: int, short: int) -> list:
    """Return the mirrored digits of an index below 2**bits whose ``short`` lowest digits are taken away.

    They are in units of base**-LOW_DIGITS: whole units, and a fraction where there are more digits.
    """
    Float = _float_of(index)
    low, high = LOW_DIGITS[base] - short, HIGH_DIGITS[base]
    if 2**bits <= base ** LOW_DIGITS[base]:
        return [_mirror(Float(index), base, digits_of(base, bits) - short, low)]
    quotient = index // base**low
    rest = index - quotient * base**low
    digits = min(digits_of(base, bits) - LOW_DIGITS[base], high)
    return [_mirror(Float(rest), base, low, low), _mirror(Float(quotient), base, digits, high) * (1.0 / base**high)]


def digits_of(base: int, bits: int) -> int:
    """Return the number of digits that every index below 2**bits needs."""
    digits = 1
    while base**digits < 2**bits:
        digits += 1
    return digits


def _mirror(number, base: int, digits: int, places: int):
    """Return the lowest ``digits`` digits of ``number`` (which has no more), mirrored within ``places`` digits."""
    return _mirror_chains(number, base, digits) * float(base ** (places - digits))


def _mirror_chains(number, base: int, digits: int):
    """Return mirrored digits; halves are computed side by side until a chain of dependent instructions is short."""
    if digits > CHAIN:
        low = (digits + 1) // 2
        quotient = _quotient(number, base**low)
        rest = dr.fma(quotient, -float(base**low), number)
        return dr.fma(
            _mirror_chains(rest, base, low), float(base ** (digits - low)), _mirror_chains(quotient, base, digits - low)
        )
    mirrored = type(number)(0)
    for _ in range(digits - 1):
        quotient = _quotient(number, base)
        mirrored = dr.fma(mirrored, base, dr.fma(quotient, -base, number))
        number = quotient
    return dr.fma(mirrored, base, number)


def _quotient(number, divisor: int):
    """Return the whole part of number / divisor, exact below 2^22 for the divisors used here: rounding is below half a step."""
    return dr.floor(dr.fma(number, 1.0 / divisor, 0.5 / divisor))
