"""Reflectance and emission at points of patches: with images, what these have there."""

import numpy as np

from .model import Patches


def values_at(patches: Patches, what: str, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return reflectances or emissions, (m, n_bands) float64.

    Args:
        what: "reflectance" or "emission".
        patch: (m,) on whose side each point lies.
        u, v: (m,) face coordinates.
    """
    scene = patches.scene
    paint = getattr(scene, f"{what}_paint")
    values = getattr(patches, what)[patch]
    if paint is None or getattr(patches, f"own_{what}") is not None:
        return values
    face = patches.face[patch]
    rows = np.flatnonzero(paint.painted[face])
    some = face[rows]
    back = patches.is_back[patch[rows]][:, None]
    base = np.where(back, getattr(scene, f"back_{what}")[some], getattr(scene, what)[some])
    values[rows] = np.minimum(base * paint.factor(some, u[rows], v[rows], scene.is_quad[some]), paint.limit)
    return values
