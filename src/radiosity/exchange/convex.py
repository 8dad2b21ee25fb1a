"""A test for scenes where nothing can stand between two patches: all that are not in one plane face each other."""

import numpy as np

from ..patches.model import Patches

SAME = 1e-6  # of the scene's size, and of unit normals: planes that differ by less are one


def is_convex(patches: Patches, facing: int) -> bool:
    """Return whether every pair of patches in different planes is among those that face each other.

    Where rounding parts a plane in two the answer is no, and errors are larger than they need be.

    Args:
        facing: how many pairs of patches face each other.
    """
    n, corners, normal = len(patches), patches.corners, patches.normal
    centre = corners.mean(axis=(0, 1))
    size = max(float(np.abs(corners - centre).max(initial=0.0)), np.finfo(float).tiny)
    offset = np.einsum("ij,ij->i", corners[:, 0] - centre, normal) / size
    planes = np.round(np.column_stack([normal, offset]) / SAME).astype(np.int64)
    together = np.unique(planes, axis=0, return_counts=True)[1]
    return facing >= (n * (n - 1) - int((together * (together - 1)).sum())) // 2
