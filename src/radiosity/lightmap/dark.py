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


def dark_and_dim(solution, look: Gathered, patch: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which sides of faces are dark and which are dim, (n_faces, 2) bool each, fronts and backs.

    To dark ones no light comes, in the middle of any patch. Dim ones receive little in the mean; or at the middles, where no line
    of the solution came.

    Args:
        look: gathers light at points.
        patch: (m,) see `unlit`.
    """
    patches = solution.patches
    sides, n = _sides(patches), 2 * patches.scene.n_faces
    level = np.nan_to_num(solution.irradiance).mean(axis=1)
    received, area = (np.bincount(sides, weight, n) for weight in (level * patches.area, patches.area))
    little = DIM * received.sum() / max(area[received > 0].sum(), np.finfo(float).tiny)
    shines = np.bincount(sides, patches.emission.any(axis=1), n) > 0
    light = np.abs(look.gather.irradiance(patch, *_middles(patches, patch).T)).max(axis=1, initial=0.0)
    most, asked = np.zeros(n), np.bincount(sides[patch], minlength=n) > 0
    np.maximum.at(most, sides[patch], light)
    dark = asked & (most == 0)
    dim = ~dark & ~shines & np.where(asked, most < little, received < little * area)
    return dark.reshape(-1, 2), dim.reshape(-1, 2)


def _middles(patches: Patches, patch: np.ndarray) -> np.ndarray:
    """Return face coordinates of the middles of patches, (m, 2)."""
    face = patches.face[patch]
    column, row, inverted = (values[patch] for values in patches.place)
    is_quad = patches.scene.is_quad[face]
    corners = cells.corners(column, row, inverted, patches.columns[face], patches.rows[face], is_quad)
    return np.where(is_quad[:, None], corners.mean(axis=1), corners[:, :3].mean(axis=1))


def _sides(patches: Patches) -> np.ndarray:
    """Return the number of each patch's side of a face, (n_patches,) int64."""
    return 2 * patches.face.astype(np.int64) + patches.is_back
