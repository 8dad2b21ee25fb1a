"""Polynomials on patches, one on each: their values at places."""

from collections.abc import Callable
from dataclasses import dataclass, replace
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
        errors: the standard errors of both, where they are known; else None.
    """

    patches: Patches
    basis: Basis
    mean: np.ndarray
    others: np.ndarray
    errors: tuple[np.ndarray, np.ndarray] | None = None

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

    def columns(self, change: Callable[[np.ndarray], np.ndarray]) -> "Polynomials":
        """Return polynomials of other columns: a linear function makes them of (n_patches, n) or (n_patches, n, K - 1) values.

        Errors go through it as if those of all columns came from the same lines: never too small.
        """
        errors = None if self.errors is None else (change(self.errors[0]), change(self.errors[1]))
        return replace(self, mean=change(self.mean), others=change(self.others), errors=errors)

    @cached_property
    def without_noise(self) -> "Polynomials":
        """The polynomials without what replicates show to be noise of their coefficients.

        The coefficients of a degree are multiplied by the share of their square sum that is no noise, on each patch, all columns
        together. Where a degree is lost in noise it is left out. Means stay as they are.
        """
        if self.errors is None or np.isnan(self.errors[1]).any():
            return self
        kept = np.ones_like(self.others)
        degrees = np.array([sum(powers) for powers in self.basis.powers[1:]])
        for degree in range(1, self.basis.degree + 1):
            some = degrees == degree
            square = (self.others[:, :, some] ** 2).sum(axis=(1, 2))
            noise = (self.errors[1][:, :, some] ** 2).sum(axis=(1, 2))
            share = 1 - np.divide(noise, square, out=np.ones_like(square), where=square > 0)
            kept[:, :, some] = np.clip(share, 0, 1)[:, None, None]
        return replace(self, others=self.others * kept, errors=(self.errors[0], self.errors[1] * kept))

    def error_at_corners(self) -> np.ndarray | None:
        """Return standard errors at the corners of patches, (n_patches, 4, n), as in `at_corners`; None where unknown."""
        if self.errors is None or np.isnan(self.errors[0]).any():
            return None
        return np.sqrt(self._at_corners(self.errors[0] ** 2, self.errors[1] ** 2, 2))

    def at_corners(self) -> np.ndarray:
        """Return values at the corners of patches, (n_patches, 4, n), in the order of `Patches.corners`."""
        return self._at_corners(self.mean, self.others, 1)

    def _at_corners(self, mean: np.ndarray, others: np.ndarray, power: int) -> np.ndarray:
        """Return sums of coefficients times powers of the functions at the corners of patches."""
        quad = self.patches.scene.is_quad[self.patches.face]
        found = np.empty((len(mean), 4, mean.shape[1]))
        for some, places, turned in ((quad, CORNERS, [0, 3, 2, 1]), (~quad, CORNERS_OF_TRIANGLE, [0, 2, 1, 1])):
            functions = self.basis.at(places[:, 0], places[:, 1], np.array(places is CORNERS))[:, 1:] ** power
            for side, order in ((~self.patches.is_back, [0, 1, 2, 3]), (self.patches.is_back, turned)):
                rows = np.flatnonzero(some & side)
                found[rows] = mean[rows, None] + np.einsum("mnk,ck->mcn", others[rows], functions[order])
        return found

    @cached_property
    def _cells(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.patches.place
