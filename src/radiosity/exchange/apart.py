"""Groups that cannot see each other: every patch of one lies behind, or in, the plane of every patch of the other."""

import numpy as np

from ..factors.polygons.short_axes import largest
from ..patches.model import Patches
from .groups import Groups

MOST = 2048  # patches: with more, nothing is found out
FLAT = 1e-9  # of the scene's size: corners no further in front of a plane lie in it
ROWS = 64  # patches at a time


def apart(patches: Patches, groups: Groups, met: np.ndarray) -> np.ndarray:
    """Return row * n + column of groups that cannot see each other, (k,) int64 ascending; none where there are too many patches.

    Args:
        met: codes of groups that a line has joined, which see each other whatever rounding says.
    """
    n, count = len(groups.names), len(patches)
    if count > MOST:
        return np.zeros(0, np.int64)
    front = in_front(patches, FLAT)
    sees = np.zeros((n, n), bool)
    one, other = np.nonzero(front & front.T)
    sees[groups.labels[one], groups.labels[other]] = True
    sees.ravel()[met] = True
    return np.flatnonzero(~sees)


def in_front(patches: Patches, least: float = -FLAT) -> np.ndarray:
    """Return which patches have a corner in front of which planes, (n_patches, n_patches) bool: in [i, j] j and i's plane.

    Args:
        least: corners further in front than this are in front, relative to the scene's size; below 0 some that lie in the plane
            are among them.
    """
    count, corners, normal = len(patches), patches.corners, patches.normal
    size = np.abs(corners - corners.mean(axis=(0, 1))).max(initial=0.0)
    plane = np.einsum("ij,ij->i", corners[:, 0], normal)
    front = np.zeros((count, count), bool)
    for at in range(0, count, ROWS):
        rows = slice(at, at + ROWS)
        heights = normal[rows] @ corners.reshape(-1, 3).T - plane[rows, None]
        front[rows] = largest(heights.reshape(-1, 4)).reshape(-1, count) > least * size
    return front
