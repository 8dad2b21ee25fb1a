"""The radiosity that cosine lines read where they hit, its correction along stored lines, and its bias."""

from dataclasses import dataclass, replace

import drjit as dr
import numpy as np

from .rows import Rows

ROUGHLY = 5.0  # times the tolerance: the bias need not be known as well


@dataclass(frozen=True, eq=False)
class Reading:
    """Reflected radiosity of each lane, in shares of the largest emission; a list has an entry for each group of bands, or K
    coefficients for each.

    The solution along m stored lines has a bias that goes as 1 / m. So it is corrected also along each half of the lines. Errors
    that are linear in the lines cancel in the mean of both less the whole; what is left is the bias.

    Attributes:
        reflected: what lines read.
        halves: what it would be by the first half of the lines, then by the second, less ``reflected``; twice as many entries.
        first: the bias of irradiance after the first correction.
        left: what corrections have left of it.
        missing: (replicates,) float64, what iterations have left of the last correction, at most.
    """

    reflected: list
    halves: list
    first: list
    left: list
    missing: np.ndarray

    @staticmethod
    def nothing(kind, lanes: int, columns: int, replicates: int) -> "Reading":
        """Return what is read before the first correction: zero."""
        one, two, three, four = ([dr.zeros(kind, lanes) for _ in range(count * columns)] for count in (1, 2, 1, 1))
        return Reading(one, two, three, four, np.zeros(replicates))

    def corrected(self, rows: Rows, irradiance: list, tolerance: np.ndarray, *, first: bool) -> tuple["Reading", list]:
        """Return what lines read from now on, and by how much more of it each lane's lines meet, in the mean over stored lines.

        Args:
            irradiance: what all lines so far say, of each column.
            tolerance: of each replicate, see `Rows.solve`.
            first: it is the first correction.
        """
        columns = len(self.reflected)
        right = [sent - read for sent, read in zip(rows.scatter.of(irradiance), self.reflected, strict=True)]
        met = [*rows.means(self.halves[:columns]), *rows.means(self.halves[columns:])]
        rights = [start + sent - half for start, sent, half in zip(right * 2, rows.scatter.of(met), self.halves, strict=True)]
        dr.eval(right, rights)
        more, missing = rows.solve(right, tolerance)
        of_halves = [
            one
            for half in (0, 1)
            for one in rows.solve(rights[half * columns : (half + 1) * columns], ROUGHLY * tolerance, more, half)[0]
        ]
        reflected = [value + one for value, one in zip(self.reflected, more, strict=True)]
        halves = [half + one - whole for half, one, whole in zip(self.halves, of_halves, more * 2, strict=True)]
        if not first:  # along few lines a correction may go astray; a bias does not grow
            halves = [dr.select(dr.abs(new) < dr.abs(old), new, old) for new, old in zip(halves, self.halves, strict=True)]
        left = rows.means([(a + b) * 0.5 for a, b in zip(halves[:columns], halves[columns:], strict=True)])
        means = rows.means(more)
        dr.eval(reflected, halves, left, means)
        reading = replace(self, reflected=reflected, halves=halves, left=left, missing=missing)
        return (replace(reading, first=left) if first else reading), means
