"""Codes of entries, row * width + column: each of them once, and where each stands.

Where all codes that are possible are few, a table finds them. Otherwise they are sorted.
"""

from dataclasses import dataclass

import numpy as np

TABLE = 1 << 22  # possible codes: with more there is no table


@dataclass(frozen=True, eq=False)
class Codes:
    """Codes that exist.

    Attributes:
        each: (m,) int64, ascending, each once.
        table: (size,) int64, where each possible code stands, and anything for codes that do not exist; None without a table.
    """

    each: np.ndarray
    table: np.ndarray | None

    @staticmethod
    def of(codes: np.ndarray, size: int) -> "Codes":
        """Find those that exist.

        Args:
            codes: (k,) int, from 0 to size - 1, some of them several times.
        """
        if size <= TABLE:
            exists = np.zeros(size, bool)
            exists[codes] = True
            return Codes(np.flatnonzero(exists), np.cumsum(exists) - 1)
        ordered = np.sort(codes)
        first = np.ones(len(ordered), bool)
        np.not_equal(ordered[1:], ordered[:-1], out=first[1:])
        return Codes(ordered[first], None)

    def __len__(self) -> int:
        return len(self.each)

    def place(self, codes: np.ndarray) -> np.ndarray:
        """Return where codes that exist stand, (k,) int64."""
        return self.each.searchsorted(codes) if self.table is None else self.table[codes]
