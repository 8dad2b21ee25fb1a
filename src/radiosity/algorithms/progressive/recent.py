"""Recent rows of form factors. They are kept since a bright patch soon shoots again, and made together since that is faster."""

import numpy as np

from ...factors.rows import AbstractRows, Swept

MOST_ENTRIES = 1 << 22  # most form factors that are kept, 16 bytes each: far less than a matrix
AHEAD = 16  # most rows that are made together


class RecentRows:
    """Rows by patch number. Which of them are kept changes no value, only how often lines are traced.

    Attributes:
        lines: lines traced so far.
    """

    def __init__(self, rows: AbstractRows):
        self.rows, self.lines, self._entries = rows, 0, 0
        self._kept: dict[int, tuple[np.ndarray, np.ndarray, float, float]] = {}

    def get(self, number: int, unshot: np.ndarray, swept: Swept) -> tuple[np.ndarray, np.ndarray, float, float]:
        """Return the columns, values, escaped and lost share of a patch's row.

        If the row must be made, rows of the patches with the most ``unshot`` power, (n,) W, that are not kept are made, too.
        """
        if number not in self._kept:
            count = min(self.rows.at_once, AHEAD)
            likely = np.argsort(-unshot, kind="stable")[: 2 * AHEAD]
            likely = [int(i) for i in likely if unshot[i] > 0 and int(i) not in self._kept and i != number]
            self.make([number, *likely][:count], swept)
        return self._kept[number]

    def make(self, numbers: list[int], swept: Swept) -> None:
        """Trace rows and keep them, and forget the oldest."""
        made = self.rows.make(np.array(sorted(numbers)), 0, swept)
        self.lines += made.lines
        for at, number in enumerate(made.numbers):
            self._kept[int(number)] = (*made.row(at), float(made.escaped[at]), float(made.lost[at]))
            self._entries += int(made.begin[at + 1] - made.begin[at])
        for old in list(self._kept)[: -len(numbers)]:
            if self._entries <= MOST_ENTRIES:
                break
            self._entries -= len(self._kept.pop(old)[0])

    @property
    def numbers(self) -> np.ndarray:
        """Return the patches whose rows are kept, the oldest first, (k,) int64."""
        return np.array(list(self._kept), np.int64)
