"""The matrix F, sparse."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .rows import Rows


@dataclass(frozen=True, eq=False)
class Matrix:
    """All form factors of a scene.

    Attributes:
        factors: (n, n) scipy CSR array, F_ij; or, of `sent`, A_j F_ji / A_i.
        escaped, lost: (n,) float64, share of what leaves a patch that leaves the scene, or lands on absorbing backs.
    """

    factors: Any
    escaped: np.ndarray
    lost: np.ndarray

    @staticmethod
    def of(rows: Rows, n: int) -> "Matrix":
        """From the rows of all patches in order."""
        from scipy.sparse import csr_array

        factors = csr_array((rows.values, rows.columns, rows.begin), shape=(n, n))
        return Matrix(factors, rows.escaped, rows.lost)

    def sent(self, area: np.ndarray) -> "Matrix":
        """For light that goes by the lines' own directions, where backs that let lines pass make what a patch sees another thing
        than what sees it: A_j F_ji / A_i in place of F_ij."""
        from scipy.sparse import diags_array

        factors = diags_array(1 / area) @ self.factors.T @ diags_array(area)
        return Matrix(factors.tocsr(), self.escaped, self.lost)
