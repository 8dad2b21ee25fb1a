"""Answers of sides: links that light up a cluster are replaced, at last, by links to each of its sides.

All sides of a cluster get the same irradiance H, whatever way they face and whatever hides them. That is wrong by about as much
as it is: some get nothing, and others several times as much. So such a link adds some A_r H² to the squared error, and it takes
a link for each of n sides to mend it. Those with the largest A_r H² / n are mended first, as far
as new links go.
"""

import numpy as np

from .levels import Levels
from .links import Links


def replaced(levels: Levels, links: Links, brought: np.ndarray, most: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return which links are replaced, (m,) bool, and the receivers and sources of the pairs that replace them.

    Args:
        brought: (m,) float64, the irradiance that each link brings, summed over bands, W/m² or lm/m².
        most: new links.
    """
    clusters, count = levels.clusters, len(levels.hierarchy)
    chosen = np.zeros(len(links), bool)
    rows = np.flatnonzero(links.receiver >= count)
    if clusters is None or not len(rows):
        return chosen, rows[:0], rows[:0]
    cluster = links.receiver[rows] - count
    sides = clusters.end[cluster] - clusters.begin[cluster]
    error = brought[rows]
    order = np.argsort(-clusters.area[cluster] * error**2 / sides, kind="stable")
    order = order[: np.searchsorted(np.cumsum(sides[order]), most, side="right")]
    order = order[error[order] > 0]
    chosen[rows[order]] = True
    begin, sides = clusters.begin[cluster[order]], sides[order]
    first = np.cumsum(sides) - sides
    place = np.arange(sides.sum()) + np.repeat(begin - first, sides)
    return chosen, levels.hierarchy.first[clusters.order[place]], np.repeat(links.source[rows[order]], sides)
