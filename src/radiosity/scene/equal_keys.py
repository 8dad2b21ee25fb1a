"""Sorted keys, whose low bits are the number of an entry: entries with equal high bits become neighbours.

NumPy sorts plain numbers many times faster than it finds the order of rows.
"""

import numpy as np

from ..pieces import in_threads, of_pieces

MIX = np.uint64(0x9E3779B97F4A7C15)  # an odd number without a pattern: 2^64 over the golden ratio
HALF = np.uint64(32)
SHARED = 1 << 18  # keys, from which on two threads sort them


def mixed(values: np.ndarray) -> np.ndarray:
    """Return (n,) uint64 whose high bits depend on all bits of those that are given."""
    result = values * MIX
    result ^= result >> HALF
    result *= MIX
    return result


def sort(keys: np.ndarray) -> None:
    """Sort keys, (n,) uint64, in place."""
    half = len(keys) // 2
    if len(keys) < SHARED:
        return keys.sort()
    keys.partition(half)
    in_threads(lambda part: keys[part].sort(), [slice(0, half), slice(half, len(keys))])


def follows(keys: np.ndarray, low_bits: int) -> np.ndarray:
    """Return which sorted keys, (n,), have the same high bits as the key before them, (n + 1,) bool; last, that nothing does."""
    result = np.zeros(len(keys) + 1, bool)
    below = np.uint64(1 << low_bits)

    def compare(part: slice) -> None:
        begin = max(part.start, 1)
        result[begin : part.stop] = (keys[begin : part.stop] ^ keys[begin - 1 : part.stop - 1]) < below

    of_pieces(compare, len(keys))
    return result


def grouped(numbers: np.ndarray) -> np.ndarray:
    """Return an order in which equal numbers, (n,) int64, follow each other, in their own order; the others come in any."""
    keys = mixed(numbers.view(np.uint64))
    order = together(keys)
    some, follow = numbers[order], follows(keys[order], _bits(len(keys)))[1:-1]
    if (some[1:][follow] != some[:-1][follow]).any():  # unequal ones whose high bits are equal by chance
        return np.argsort(numbers, kind="stable")
    return order


def together(keys: np.ndarray) -> np.ndarray:
    """Return an order by the high bits of keys, (n,) uint64; the low bits, as many as the number of keys has, do not count."""
    low = np.uint64((1 << _bits(len(keys))) - 1)
    numbered = keys & ~low
    numbered |= np.arange(len(keys), dtype=np.uint64)
    sort(numbered)
    numbered &= low
    return numbered.view(np.int64)


def _bits(count: int) -> int:
    return max(count - 1, 1).bit_length()
