"""Answers of sides: links that light up a cluster are replaced, at last, by links to each of its sides.

All sides of a cluster get the same irradiance, whatever way they face and whatever hides them. A link whose answer is wrong by
e = spread times B of the source adds at most A_r e² to the squared error, and it takes a link for each of n sides to mend it.
So those with the largest A_r e² / n are mended first, until as many links are new as there were.
"""

import numpy as np

from .levels import Levels
from .links import Links
from .refine import MOST_LINKS


def replaced(levels: Levels, links: Links, radiosity: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return which links are replaced, (m,) bool, and the receivers and sources of the pairs that replace them.

    Args:
        radiosity: (n_elements, n_bands) means over elements, W/m² or lm/m².
    """
    clusters, count = levels.clusters, len(levels.hierarchy)
    chosen = np.zeros(len(links), bool)
    rows = np.flatnonzero(links.receiver >= count)
    if clusters is None or not len(rows):
        return chosen, rows[:0], rows[:0]
    cluster = links.receiver[rows] - count
    sides = clusters.end[cluster] - clusters.begin[cluster]
    error = links.spread[rows] * radiosity[links.source[rows]].sum(axis=1)
    order = np.argsort(-clusters.area[cluster] * error**2 / sides, kind="stable")
    most = min(len(links), MOST_LINKS - len(links))
    order = order[: np.searchsorted(np.cumsum(sides[order]), most, side="right")]
    order = order[error[order] > 0]
    chosen[rows[order]] = True
    begin, sides = clusters.begin[cluster[order]], sides[order]
    first = np.cumsum(sides) - sides
    place = np.arange(sides.sum()) + np.repeat(begin - first, sides)
    return chosen, levels.hierarchy.first[clusters.order[place]], np.repeat(links.source[rows[order]], sides)
