"""Sparse counts of lines between patches, kept as sorted 64-bit keys."""

import numpy as np

LEAST = 1 << 20  # keys that are gathered before they are merged into the rest
CODE = np.uint64(0xFFFFFFFF)
WORD = np.uint64(32)


class PairCounts:
    """The number of lines of each row that end at each column; each row and column is a number below 2^32.

    Keys are row * 2^32 + column. New keys are sorted and counted launch by launch, and merged when there are half as many of
    them as are already merged, so that a key is moved a few times only.
    """

    def __init__(self, keys: np.ndarray | None = None, counts: np.ndarray | None = None):
        self._keys = np.zeros(0, np.uint64) if keys is None else keys
        self._counts = np.zeros(0, np.uint32) if counts is None else counts
        self._new: list[tuple[np.ndarray, np.ndarray]] = []

    def add(self, rows: np.ndarray, columns: np.ndarray) -> None:
        """Add lines: ``rows`` and ``columns`` are (m,) whole numbers each, one line an entry."""
        keys = np.sort((rows.astype(np.uint64) << WORD) | columns.astype(np.uint64))
        self._new.append(_merged(keys, None))
        if sum(len(keys) for keys, _ in self._new) > max(LEAST, len(self._keys) // 2):
            self._merge()

    def _merge(self) -> None:
        if self._new:
            keys = np.concatenate([self._keys, *(keys for keys, _ in self._new)])
            counts = np.concatenate([self._counts, *(counts for _, counts in self._new)])
            order = np.argsort(keys, kind="stable")  # runs that are sorted already are merged
            self._keys, self._counts = _merged(keys[order], counts[order])
            self._new = []

    @property
    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Return keys, (m,) uint64 ascending, and counts, (m,) uint32 where that suffices, else uint64."""
        self._merge()
        return self._keys, self._counts

    def __len__(self) -> int:
        """Return the number of entries, or somewhat more: what is not merged yet may hold some twice."""
        return len(self._keys) + sum(len(keys) for keys, _ in self._new)


def _merged(keys: np.ndarray, counts: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Make equal neighbours one; ``counts`` None are ones."""
    if len(keys) == 0:
        return keys, np.zeros(0, np.uint32)
    first = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]]))
    if counts is None:
        return keys[first], np.diff(first, append=len(keys)).astype(np.uint32)
    wide = counts.dtype.itemsize > 4 or int(counts.sum(dtype=np.uint64)) >> 32 > 0
    found = np.add.reduceat(counts, first, dtype=np.uint64 if wide else np.uint32)
    return keys[first], found if wide and int(found.max()) >> 32 > 0 else found.astype(np.uint32, copy=False)


def split(keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return rows and columns of keys, (m,) int64 each."""
    return (keys >> WORD).astype(np.int64), (keys & CODE).astype(np.int64)
