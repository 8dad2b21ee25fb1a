"""Sides of faces that no light reaches, or little of it, such as the outsides of a closed room and the insides of its walls.

Dark ones have no charts of their own. All of them share one texel, which is black, so that the page is there for what is seen.
Dim ones share no chart with brighter ones. So nothing dark bleeds into lit parts of a surface that is cut where walls stand.
"""

import numpy as np

from ..image.gathered import Gathered
from ..patches import Patches, cells

DIM = 0.05  # of the mean over what is lit
OF_MIDDLES = 64  # lines from the middle of a patch


def unlit(solution) -> np.ndarray:
    """Return the patches of sides of faces where no line of a solution brought light, and that emit none, (m,) int64."""
    patches = solution.patches
    light = np.nan_to_num(solution.irradiance) + np.nan_to_num(solution.radiosity) + patches.emission
    lit = (light > 0).any(axis=1)
    return np.flatnonzero(np.bincount(_sides(patches), lit, 2 * patches.scene.n_faces)[_sides(patches)] == 0)


def dark_sides(look: Gathered, patch: np.ndarray) -> np.ndarray:
    """Return which sides of faces are dark, (n_faces, 2) bool, fronts and backs: no light comes to the middle of any patch.

    Args:
        look: gathers light at points.
        patch: (m,) see `unlit`.
    """
    patches = look.lookup.patches
    sides, face = _sides(patches)[patch], patches.face[patch]
    column, row, inverted = (values[patch] for values in patches.place)
    corners = cells.corners(column, row, inverted, patches.columns[face], patches.rows[face], patches.scene.is_quad[face])
    middle = np.where(patches.scene.is_quad[face][:, None], corners.mean(axis=1), corners[:, :3].mean(axis=1))
    light = (look.gather.irradiance(patch, *middle.T) != 0).any(axis=1)
    n = 2 * patches.scene.n_faces
    return ((np.bincount(sides, minlength=n) > 0) & (np.bincount(sides, light, n) == 0)).reshape(-1, 2)


def dim_sides(solution) -> np.ndarray:
    """Return which sides of faces receive little light in the mean, (n_faces, 2) bool, and emit none.

    Of those where no line came nothing is known: they are dark, or small.
    """
    patches = solution.patches
    sides, n = _sides(patches), 2 * patches.scene.n_faces
    level = np.nan_to_num(solution.irradiance).mean(axis=1)
    received, area = (np.bincount(sides, weight, n) for weight in (level * patches.area, patches.area))
    of_all = received.sum() / max(area[received > 0].sum(), np.finfo(float).tiny)
    shines = np.bincount(sides, patches.emission.any(axis=1), n) > 0
    return ((received > 0) & (received < DIM * of_all * area) & ~shines).reshape(-1, 2)


def _sides(patches: Patches) -> np.ndarray:
    """Return the number of each patch's side of a face, (n_patches,) int64."""
    return 2 * patches.face.astype(np.int64) + patches.is_back
