"""Sparse form factors."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class Factors:
    """Sparse form factors of one replicate.

    Attributes:
        rows, columns: (m,) int64, patches.
        values: (m,) float64, F_ij: share of what leaves patch ``rows`` that arrives at patch ``columns``.
        escaped, lost: (n,) float64, share of what leaves a patch that leaves the scene, or ends on absorbing backs.
    """

    rows: np.ndarray
    columns: np.ndarray
    values: np.ndarray
    escaped: np.ndarray
    lost: np.ndarray

    def sent(self, area: np.ndarray) -> "Factors":
        """Return the form factors that `gather` needs where light goes in the lines' own directions: A_i F_ij / A_j for F_ji.

        Backs that let lines pass make the two different.
        """
        values = self.values * area[self.rows] / area[self.columns]
        return Factors(self.columns, self.rows, values, self.escaped, self.lost)

    def gather(self, radiosity: np.ndarray) -> np.ndarray:
        """Return irradiance, sum_j F_ij B_j, (n,)."""
        if self._ordered is not None:
            return self._ordered @ radiosity
        return np.bincount(self.rows, weights=self.values * radiosity[self.columns], minlength=len(radiosity))

    @cached_property
    def _ordered(self):
        """A CSR array of the entries as they stand, which adds up as `numpy.bincount` does; None where they are not by rows."""
        if (self.rows[1:] < self.rows[:-1]).any():
            return None
        from scipy.sparse import csr_array

        n = len(self.escaped)
        first = np.searchsorted(self.rows, np.arange(n + 1))
        return csr_array((self.values, self.columns, first), shape=(n, n))

    def sparse(self, n: int):
        """Return an (n, n) scipy CSR array, F_ij in row i."""
        from scipy.sparse import coo_array

        return coo_array((self.values, (self.rows, self.columns)), shape=(n, n)).tocsr()

    def dense(self) -> np.ndarray:
        """Return an (n, n) float64 array, F_ij in row i."""
        n = len(self.escaped)
        return np.bincount(self.rows * n + self.columns, weights=self.values, minlength=n * n).reshape(n, n)
