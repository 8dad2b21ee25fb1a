"""Groups that cannot see each other: every patch of one lies behind, or in, the plane of every patch of the other."""

import numpy as np

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
    corners, normal = patches.corners, patches.normal
    size = np.abs(corners - corners.mean(axis=(0, 1))).max()
    plane = np.einsum("ij,ij->i", corners[:, 0], normal)
    front = np.zeros((count, count), bool)  # [i, j]: some of j is in front of i
    for at in range(0, count, ROWS):
        rows = slice(at, at + ROWS)
        heights = np.einsum("ix,jkx->ijk", normal[rows], corners) - plane[rows, None, None]
        front[rows] = heights.max(axis=2) > FLAT * size
    sees = np.zeros((n, n), bool)
    one, other = np.nonzero(front & front.T)
    sees[groups.labels[one], groups.labels[other]] = True
    sees.ravel()[met] = True
    return np.flatnonzero(~sees)
