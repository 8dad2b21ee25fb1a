"""Polynomials on patches, one on each: their values at places."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .bases import Basis
from .model import Patches

CORNERS = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
CORNERS_OF_TRIANGLE = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, 1.0)])


@dataclass(frozen=True, eq=False)
class Polynomials:
    """A polynomial on each patch, for each of n bands or other columns.

    Attributes:
        patches: on which they are.
        basis: of the polynomials.
        mean: (n_patches, n) float64, the coefficients of 1.
        others: (n_patches, n, K - 1) float64, the coefficients of the other functions.
    """

    patches: Patches
    basis: Basis
    mean: np.ndarray
    others: np.ndarray

    def at(self, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return values at points of patches, (m, n), from face coordinates u and v."""
        return self.at_places(patch, *self.place(patch, u, v))

    def place(self, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return coordinates within patches of points with face coordinates u and v."""
        column, row, inverted = (values[patch] for values in self._cells)
        face = self.patches.face[patch]
        a, b = u * self.patches.columns[face] - column, v * self.patches.rows[face] - row
        return np.where(inverted, 1 - a, a), np.where(inverted, 1 - b, b)

    def at_places(self, patch: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Return values at coordinates within patches, (m, n)."""
        functions = self.basis.at(a, b, self.patches.scene.is_quad[self.patches.face[patch]])
        return self.mean[patch] + np.einsum("mnk,mk->mn", self.others[patch], functions[:, 1:])

    def at_corners(self) -> np.ndarray:
        """Return values at the corners of patches, (n_patches, 4, n), in the order of `Patches.corners`."""
        quad = self.patches.scene.is_quad[self.patches.face]
        found = np.empty((len(self.mean), 4, self.mean.shape[1]))
        for some, places, turned in ((quad, CORNERS, [0, 3, 2, 1]), (~quad, CORNERS_OF_TRIANGLE, [0, 2, 1, 1])):
            functions = self.basis.at(places[:, 0], places[:, 1], np.array(places is CORNERS))[:, 1:]
            for side, order in ((~self.patches.is_back, [0, 1, 2, 3]), (self.patches.is_back, turned)):
                rows = np.flatnonzero(some & side)
                found[rows] = self.mean[rows, None] + np.einsum("mnk,ck->mcn", self.others[rows], functions[order])
        return found

    @cached_property
    def _cells(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.patches.place
