"""What few lines cannot show: a pair of surfaces that no line joined is not known to exchange nothing.

Replicates agree about such a pair. By Poisson's distribution a count of c lines is known to its square root, and that of no line
to one line. So where fewer than `FEW` lines joined two surfaces, so many lines' worth of exchange is added to the standard error.
Where more did and all replicates agree to rounding, it is one line: what fewer lines would meet, such as the rims of a thin gap,
is not there.
"""

import numpy as np

from ..patches.model import Patches
from ..solution.intervals import FEW
from .apart import apart
from .groups import Groups
from .network import Pooled


def watts(pooled: Pooled, patches: Patches, radiosity: np.ndarray, around: float | None, agreed: np.ndarray) -> np.ndarray:
    """Return W that exchanges may be off by, (k + 1, k + 1), symmetric; the last row and column are the surroundings.

    Args:
        radiosity: (k,) W/m² of the surfaces.
        around: W/m² of the surroundings, None where there are none.
        agreed: (k + 1, k + 1) bool, pairs about which all replicates agree.
    """
    k, labels = len(radiosity), patches.surface
    counts = pooled.between(labels, k)
    density = np.bincount(labels, pooled.lines, k) / np.maximum(np.bincount(labels, pooled.area, k), np.finfo(float).tiny)
    lines = np.where(counts < FEW, np.sqrt(np.maximum(counts, 1)), agreed[:k])
    blind = apart(patches, Groups(patches.scene.names, labels.astype(np.int64)), np.flatnonzero(counts[:, :k] > 0))
    lines[np.unravel_index(blind, (k, k))] = 0  # planes that look away from each other exchange nothing
    result = np.zeros((k + 1, k + 1))
    with np.errstate(divide="ignore", invalid="ignore"):  # a surface without patches has no lines
        worth = 1 / (density[:, None] + density)
        result[:k, :k] = lines[:, :k] * worth * np.abs(radiosity[:, None] - radiosity)
        if around is not None:
            result[:k, k] = result[k, :k] = lines[:, k] / density * np.abs(radiosity - around)
    return np.where(np.isfinite(result), result, 0.0)
