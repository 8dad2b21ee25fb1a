"""Pixels on edges between very unlike brightness, such as the rim of a lamp, whose few samples tell too little."""

import numpy as np

AT_EDGES = 32  # lines of sight of such a pixel
CONTRAST = 0.1  # of the median pixel: the standard deviation of a pixel's mean, above which it is rough
MOST = 1 / 32  # of all pixels, at most: the roughest ones


def rough(variance: np.ndarray, flat: np.ndarray, level: np.ndarray, width: int) -> np.ndarray:
    """Return the numbers of rough pixels and of those beside them, which may hide a part of the same edge, sorted.

    Args:
        variance: (n,) of the mean of each pixel's samples.
        flat: (n,) the plane that all samples of a pixel see; -1: they see several.
        level: (n,) brightness.
        width: pixels of a row.
    """
    lit = level[level > 0]
    spread = np.where(flat < 0, np.nan_to_num(variance), 0.0)
    found = spread > (CONTRAST * np.median(lit) if len(lit) else np.inf) ** 2
    most = max(int(MOST * len(level)), 1)
    if found.sum() > most:
        found[np.argsort(-spread, kind="stable")[most:]] = False
    near = np.pad(found.reshape(-1, width), 1)
    high, wide = near.shape
    beside = [near[i : i + high - 2, j : j + wide - 2] for i in range(3) for j in range(3)]
    return np.flatnonzero(np.any(beside, axis=0))
