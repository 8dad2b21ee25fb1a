"""The planes of surfaces: patches in one plane of one surface have one number."""

import numpy as np

from ..patches import Patches

STEPS = 50  # of a normal's components: normals that differ by less have one number


def planes(patches: Patches) -> np.ndarray:
    """Return the number of each patch's plane, by surface and direction, (n_patches,) int64, from 0 on."""
    scene = patches.scene
    turned = np.round(np.concatenate([scene.normal, -scene.normal]) * STEPS).astype(np.int64)
    rows = np.column_stack([np.tile(scene.surface, 2), turned])
    number = np.unique(rows, axis=0, return_inverse=True)[1].ravel()
    return number[patches.face + np.where(patches.is_back, scene.n_faces, 0)]
