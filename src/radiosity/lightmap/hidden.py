"""Points that lie inside of something, such as below a box on a floor: all that their lines meet are backs of surfaces.

Nobody sees them, but they share texels with points that are seen, and a viewer's interpolation reads texels of them. There would
be a dark fringe around whatever stands on a surface. So a texel is the mean of its other points; where it has none, and lies
beside a texel that has, it takes the mean of these.
"""

from itertools import product

import numpy as np

from .atlas import Atlas
from .texels import Texels

BEHIND = 0.4  # share of lines that meet backs; inside of a box it is a half at the foot of a wall


def mean_of_seen(values: np.ndarray, behind: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return means over the points of texels, (parts, n, n_bands), and which texels have no point that can be seen, (n,) bool.

    Args:
        values: (parts, samples, n, n_bands).
        behind: (parts, samples, n), the share of lines that met backs.
    """
    seen = behind.mean(axis=0) < BEHIND
    hidden = ~seen.any(axis=0)
    weight = np.where(hidden, 1.0, seen)
    return np.einsum("psnb,sn->pnb", values, weight / weight.sum(axis=0)), hidden


def from_beside(page: Atlas, texels: Texels, hidden: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return values, (n, n_bands), where hidden texels beside seen ones of the same chart have the mean of these."""
    number = np.full((page.height + 2, page.width + 2), -1)
    number[texels.row + 1, texels.column + 1] = np.arange(len(texels))
    own = np.flatnonzero(hidden)
    chart = page.chart[texels.triangle]
    total, count = np.zeros((len(own), values.shape[1])), np.zeros(len(own))
    for down, right in product((0, 1, 2), repeat=2):
        other = number[texels.row[own] + down, texels.column[own] + right]
        good = (other >= 0) & ~hidden[other] & (chart[other] == chart[own])
        total[good] += values[other[good]]
        count += good
    found = values.copy()
    found[own[count > 0]] = total[count > 0] / count[count > 0, None]
    return found
