"""Rows of form factors, made when they are asked for."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .model import Factors

Swept = Callable[[int], None]


@dataclass(frozen=True, eq=False)
class Rows:
    """Form factors F_ij of some patches i.

    Attributes:
        numbers: (k,) int64, the patches i.
        begin: (k + 1,) int64: row r has entries begin[r] to below begin[r + 1].
        columns: (m,) int64, j, ascending within a row.
        values: (m,) float64, share of what leaves patch i that arrives at patch j.
        escaped, lost: (k,) float64, share that leaves the scene, and that ends on absorbing backs.
        lines: how many lines were traced for them.
    """

    numbers: np.ndarray
    begin: np.ndarray
    columns: np.ndarray
    values: np.ndarray
    escaped: np.ndarray
    lost: np.ndarray
    lines: int

    @staticmethod
    def of(numbers: np.ndarray, row: np.ndarray, columns: np.ndarray, values: np.ndarray, escaped, lost, lines: int) -> "Rows":
        """Make rows from entries in any order; ``row`` is the place of each entry in ``numbers``."""
        order = np.lexsort((columns, row))
        begin = np.searchsorted(row[order], np.arange(len(numbers) + 1))
        return Rows(numbers, begin, columns[order], values[order], escaped, lost, lines)

    def row(self, at: int) -> tuple[np.ndarray, np.ndarray]:
        """Return columns and values of the patch ``numbers[at]``."""
        part = slice(self.begin[at], self.begin[at + 1])
        return self.columns[part], self.values[part]

    @property
    def factors(self) -> Factors:
        """Return `Factors` whose rows are patch numbers; ``escaped`` and ``lost`` are of these rows."""
        return Factors(np.repeat(self.numbers, np.diff(self.begin)), self.columns, self.values, self.escaped, self.lost)


class AbstractRows(ABC):
    """A source of form factors."""

    @abstractmethod
    def make(self, numbers: np.ndarray, replicate: int, swept: Swept) -> Rows:
        """Return the rows of some patches; a row does not depend on the other patches in the call.

        Args:
            numbers: (k,) int64, patches.
            replicate: the replicate whose random numbers are taken.
            swept: called between launches with the number of lines traced since; an exception that it raises ends the work.
        """

    @property
    @abstractmethod
    def at_once(self) -> int:
        """The best number of rows for one call of `make`."""
