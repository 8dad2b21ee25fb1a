"""What polynomials on patches leave out of the light within them, from a solution on patches cut into four."""

import numpy as np

from ..patches.polynomials import Polynomials

NODES, WEIGHTS = np.polynomial.legendre.leggauss(3)  # exact up to degree 5


def apart(coarse, fine, parent: np.ndarray) -> np.ndarray:
    """Return the mean square of the difference of two solutions' radiosities over each fine patch, (n_fine, n_bands).

    Args:
        coarse, fine: solutions with polynomials, the second on patches cut into four.
        parent: (n_fine,) the coarse patch of each fine one.
    """
    patches = fine.patches
    one, other = (Polynomials(each.patches, each.basis, each.radiosity, each.radiosity_coefficients) for each in (coarse, fine))
    face, (column, row, inverted) = patches.face, patches.place
    quad = patches.scene.is_quad[face]
    x, w = (NODES + 1) / 2, WEIGHTS / 2
    total, every = np.zeros_like(fine.radiosity), np.arange(len(patches))
    for a, of_a in zip(x, w, strict=True):
        for b, of_b in zip(x, w, strict=True):
            s = np.where(quad, a, a * (1 - b))  # Duffy's map of the square to the triangle
            weight = of_a * of_b * np.where(quad, 1, 2 * (1 - b))
            u = (column + np.where(inverted, 1 - s, s)) / patches.columns[face]
            v = (row + np.where(inverted, 1 - b, b)) / patches.rows[face]
            total += weight[:, None] * (one.at(parent, u, v) - other.at_places(every, s, np.full(len(s), b))) ** 2
    return total


def noise(solution) -> np.ndarray:
    """Return the mean square error of the radiosity over each patch that the replicates tell, (n_patches, n_bands)."""
    others = solution.patches.scatter.of_moments(solution.irradiance_coefficients_standard_error)
    return solution.standard_error**2 + (others**2).sum(axis=2)
