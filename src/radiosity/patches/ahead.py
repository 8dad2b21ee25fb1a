"""What a second cut of faces gains where the first one gains nothing: pilots that look two cuts ahead.

On a strip that is dark at both ends and bright between them, halves are alike. So a cut in halves gains nothing by itself, and
the next two gain much. Quarters along each edge tell.
"""

import numpy as np

from . import cells as grid
from .halves import Halves, square_of
from .model import Patches


def quarters_of(halves: Halves) -> Patches:
    """Return the fine patches of halves, each cut in the same way again."""
    columns, rows = halves.fine.columns, halves.fine.rows
    return Patches(halves.coarse.scene, columns**2, rows**2)


def within_halves(halves: Halves, quarters: Patches, irradiance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how far light varies within halves along and across parallelograms, less noise, (n_faces,) each.

    Args:
        irradiance: (replicates, n, n_bands) of the quarters.
    """
    scene, found = halves.coarse.scene, []
    one = np.ones(scene.n_faces, np.int32)
    for columns, rows in ((quarters.columns, one), (one, quarters.rows)):
        strips = Patches(scene, np.where(scene.is_quad, columns, 1), np.where(scene.is_quad, rows, 1))
        some = np.flatnonzero(scene.is_quad & (columns * rows == 4))
        cells = Halves(halves.coarse, strips).cells(mean_over(quarters, irradiance, strips), some, 4)
        varies = np.zeros(scene.n_faces)
        varies[some] = sum(square_of(cells[..., k] - cells[..., k + 1])[0] for k in (0, 2)) / 8
        found.append(varies)
    return found[0], found[1]


def mean_over(patches: Patches, values: np.ndarray, larger: Patches) -> np.ndarray:
    """Return the means of values of patches over larger ones of the same scene, each of which holds equally many of them.

    Args:
        values: (replicates, n_patches, n_bands).
    """
    column, row, inverted = patches.place
    face, quad = patches.face, patches.scene.is_quad[patches.face]
    middle = np.where(quad, 1 / 2, np.where(inverted, 2 / 3, 1 / 3))
    columns, rows = larger.columns[face], larger.rows[face]
    cell = grid.number((column + middle) / patches.columns[face], (row + middle) / patches.rows[face], columns, rows, quad)
    owner = larger.first[face] + patches.is_back * grid.count(columns, rows) + cell
    order = np.argsort(owner, kind="stable")
    begin = np.searchsorted(owner[order], np.arange(len(larger)))
    counts = np.diff(np.append(begin, len(owner)))
    return np.add.reduceat(values[:, order], begin, axis=1) / counts[None, :, None]
