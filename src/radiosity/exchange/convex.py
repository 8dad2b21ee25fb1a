"""A test for scenes where nothing can stand between two patches: all lie on the outside of their convex hull."""

import numpy as np

from ..patches.model import Patches
from ..pieces import pieces

SAME = 1e-6  # of the scene's size, and of unit normals: planes that differ by less are one
AT_ONCE = 1 << 22  # distances of points from planes


def is_convex(patches: Patches) -> bool:
    """Return whether all patches are on one side of the plane of each, whichever side that is.

    Then a line between two of them runs inside their convex hull, and none of them does.
    """
    corners = patches.corners
    points = corners.reshape(-1, 3) - corners.mean(axis=(0, 1))
    points /= max(float(np.abs(points).max(initial=0.0)), np.finfo(float).tiny)
    offset = np.einsum("ij,ij->i", points[::4], patches.normal)
    planes = np.column_stack([patches.normal, offset])
    planes = planes[np.unique(np.round(planes / SAME).astype(np.int64), axis=0, return_index=True)[1]]
    for part in pieces(len(planes), max(AT_ONCE // len(points), 1)):
        distance = points @ planes[part, :3].T - planes[part, 3]
        if not ((distance.max(axis=0) <= SAME) | (distance.min(axis=0) >= -SAME)).all():
            return False
    return True
