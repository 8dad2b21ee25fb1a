"""What digital sequences are tested with: their leading digits, and whether points are a net."""

from collections.abc import Iterator

import numpy as np

from radiosity.device.backend import choose, upload
from radiosity.sampling.numbers import WORDS, make
from radiosity.sampling.numbers.binary import Binary

NONE, DEGREES = dict.fromkeys(range(2, 6), 0), {2: 0, 3: 1, 4: 3, 5: 5}  # the sum of the polynomials' degrees less one
T = {"faure": NONE, "generalized-faure": NONE, "niederreiter": DEGREES, "sobol": DEGREES}  # t of the first s dimensions
COMPARED = {  # the others: what their points are compared with, and where
    "halton": "scipy and whole numbers, test_numbers_halton.py",
    "scrambled-halton": "whole numbers and other programs' permutations, test_numbers_halton.py",
    "random": "known answers of Philox, test_numbers.py",
}
BASE = {"faure": 5, "generalized-faure": 5, "niederreiter": 2, "sobol": 2}


def top_digits(name, index, digits: int, drawn=None) -> np.ndarray:
    """(n, 5) int64: coordinates times base^digits, rounded down, before they become floats. ``name``: or the sequence itself."""
    types = choose("cpu").types
    numbers = make(name) if isinstance(name, str) else name
    given = [types.UInt32(int(word)) for word in (np.zeros(WORDS, np.uint32) if drawn is None else drawn)]
    index = upload(types.UInt32, np.asarray(index).astype(np.uint32))
    if isinstance(numbers, Binary):
        columns = [np.array(word).astype(np.int64) >> (32 - digits) for word in numbers.words(index, given, 32)]
    else:
        columns = [np.array(high).astype(np.int64) // 5 ** (8 - digits) for high, _ in numbers.digits(index, given, 32)]
    return np.stack([np.broadcast_to(c, len(np.array(index))) for c in columns], axis=1)


def compositions(total: int, parts: int) -> Iterator[tuple[int, ...]]:
    """All ways to write a whole number as a sum of so many."""
    if parts == 1:
        yield (total,)
        return
    for first in range(total + 1):
        for rest in compositions(total - first, parts - 1):
            yield (first, *rest)


def is_net(x: np.ndarray, base: int, digits: int, m: int, t: int) -> bool:
    """Do base^m points hold base^t in every elementary interval of volume base^(t - m)? A (t, m, s)-net (Niederreiter 1987).

    Args:
        x: (base^m, s) int64, coordinates times base^digits.
    """
    assert len(x) == base**m
    if m < t:
        return True
    for split in compositions(m - t, x.shape[1]):
        cell = np.zeros(len(x), np.int64)
        for column, depth in zip(x.T, split, strict=True):
            cell = cell * base**depth + column // base ** (digits - depth)
        if (np.bincount(cell, minlength=base ** (m - t)) != base**t).any():
            return False
    return True
