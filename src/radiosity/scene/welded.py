"""Vertices at the same place: all are known by the number of one of them."""

import numpy as np

from ..pieces import of_pieces
from .equal_keys import follows, mixed, sort

SIZE = 1 << 14  # vertices at a time
MOST = 1 << 30  # vertices: their numbers leave room for the rest of a key


def welded(vertices: np.ndarray) -> np.ndarray | None:
    """Return numbers that are equal where vertices are equal, and only there, (n,) int64, below n; None where no two are equal.

    Args:
        vertices: (n, 3) float64; plus and minus zero are equal.
    """
    n = len(vertices)
    if n > MOST:
        return _by_rows(vertices)
    low = np.uint64((1 << max(n - 1, 1).bit_length()) - 1)
    keys = np.empty(n, np.uint64)

    def make(part: slice) -> None:
        x, y, z = (np.ascontiguousarray(vertices[part, axis] + 0.0).view(np.uint64) for axis in range(3))
        keys[part] = (mixed(mixed(mixed(x) + y) + z) & ~low) | np.arange(part.start, part.stop, dtype=np.uint64)

    of_pieces(make, n)
    sort(keys)
    follow = follows(keys, int(low).bit_length())
    alike = np.flatnonzero(follow[:-1] | follow[1:])  # sorted keys that have the high bits of a neighbour
    if not len(alike):
        return None
    number = np.arange(n)
    entry, begins = (keys[alike] & low).view(np.int64), np.flatnonzero(~follow[alike])
    number[entry] = np.repeat(entry[begins], np.diff(begins, append=len(entry)))
    coordinates = np.ascontiguousarray(vertices).ravel()

    def differ(part: slice) -> np.ndarray:
        """Return vertices that are not where the one of their number is; compared in their order, which keeps to the cache."""
        result, place = np.zeros(part.stop - part.start, bool), 3 * number[part]
        for axis in range(3):
            result |= vertices[part, axis] != coordinates.take(place + axis)
        return part.start + np.flatnonzero(result)

    wrong = np.concatenate(of_pieces(differ, n, SIZE))
    if len(wrong):  # places whose high bits are equal by chance
        some = np.flatnonzero(np.isin(number, number[wrong]))
        number[some] = some[_by_rows(vertices[some])]
    return number


def _by_rows(points: np.ndarray) -> np.ndarray:
    _, first, place = np.unique(points + 0.0, axis=0, return_index=True, return_inverse=True)
    return first[place.ravel()]
