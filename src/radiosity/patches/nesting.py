"""Meshes whose cells lie within the cells of another."""

from dataclasses import replace

import numpy as np

from ..errors import SceneError
from . import cells
from .model import Patches


def halved(patches: Patches) -> Patches:
    """Return patches of which every cell is cut into four congruent ones.

    Raises:
        SceneError: faces would have more cells along an edge than can be counted.
    """
    most = int(max(patches.columns.max(), patches.rows.max()))
    if 2 * most > cells.MOST:
        raise SceneError(f"a face has {most} cells along an edge; at most {cells.MOST // 2} can be halved: take larger patches")
    fine = Patches(patches.scene, patches.columns * 2, patches.rows * 2)
    own = {name: getattr(patches, name) for name in ("own_reflectance", "own_emission")}
    return replace(fine, **{name: value[parents(fine, patches)] for name, value in own.items() if value is not None})


def parents(fine: Patches, coarse: Patches) -> np.ndarray:
    """Return the coarse patch in which each fine one lies, (n_fine,) int64.

    Args:
        fine: patches of the same scene, cut into a whole multiple of the coarse cells along every edge.
    """
    column, row, inverted = fine.place
    face, quad = fine.face, fine.scene.is_quad[fine.face]
    middle = np.where(quad, 0.5, np.where(inverted, 2 / 3, 1 / 3))
    u, v = (column + middle) / fine.columns[face], (row + middle) / fine.rows[face]
    cell = cells.number(u, v, coarse.columns[face], coarse.rows[face], quad)
    return coarse.first[face] + np.where(fine.is_back, coarse.cells_per_face[face], 0) + cell
