"""The Halton sequence (J. H. Halton, Numerische Mathematik 2, 1960) in bases 2, 3, 5, 7, 11."""

from dataclasses import dataclass

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
    """Radical inverses, each moved by a seeded shift modulo 1 (Cranley and Patterson 1976), one for the whole scene."""

    def randomisation(self, stream: np.random.SeedSequence) -> np.ndarray:
        return np.random.Generator(np.random.Philox(stream)).integers(0, 2**32, WORDS, dtype=np.uint32)

    def points(self, index, patch, randomisation, bits):
        Float = dr.float32_array_t(type(index))
        values = [Float(dr.brev(index) >> 8) * 2.0**-24, *(radical_inverse(index, base, bits) for base in BASES[1:])]
        moved = [value + Float(shift >> 8) * 2.0**-24 for value, shift in zip(values, randomisation, strict=False)]
        return [value - dr.floor(value) for value in moved]

    def steps(self):
        return STEPS

    def largest(self):
        return LARGEST


def radical_inverse(index, base: int, bits: int):
    """Digits of ``index`` (UInt32, below 2**bits) in ``base``, mirrored at the point; Float32 in [0, 1].

    Quotients are taken in single precision, which costs four instructions a digit; larger indices are split once. The
    value depends on the index alone: fewer digits are scaled by an exact power before anything is rounded.
    """
    Float = dr.float32_array_t(type(index))
    low, high = LOW_DIGITS[base], HIGH_DIGITS[base]
    if 2**bits <= base**low:
        return _mirror(Float(index), base, digits_of(base, bits), low) * (1.0 / base**low)
    quotient = index // base**low
    rest = index - quotient * base**low
    digits = min(digits_of(base, bits) - low, high)
    fraction = _mirror(Float(quotient), base, digits, high) * (1.0 / base**high)
    return (_mirror(Float(rest), base, low, low) + fraction) * (1.0 / base**low)


def digits_of(base: int, bits: int) -> int:
    """Digits that hold every index below 2**bits."""
    digits = 1
    while base**digits < 2**bits:
        digits += 1
    return digits


def _mirror(number, base: int, digits: int, places: int):
    """The lowest ``digits`` digits of ``number`` (which has no more), mirrored within ``places`` digits."""
    return _mirror_chains(number, base, digits) * float(base ** (places - digits))


def _mirror_chains(number, base: int, digits: int):
    """Mirrored digits; halves are taken side by side until a chain of dependent instructions is short."""
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
    """Whole part of number / divisor, exact below 2^22 for the divisors used here: half a step is more than the rounding."""
    return dr.floor(dr.fma(number, 1.0 / divisor, 0.5 / divisor))
