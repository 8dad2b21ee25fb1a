"""Bounds of what few lines find, so that light in narrow gaps fades.

Factors of an element sum to 1 at most, but those that few lines find may sum to more. Between bright surfaces in a narrow gap
light then grows from reflection to reflection. A bound for all would take light from the scene: sums that are too large by chance
would be cut, and none that is too small be raised. So it holds where light does not fade: where, of light that is 1 everywhere,
more than 0.98^8 is left after 8 reflections.
"""

import numpy as np

from .exchange import Exchange
from .levels import Levels
from .links import Links

STEPS = 8  # reflections
FADES = 0.98  # what is left of light after each of them, at most


def bounded(levels: Levels, links: Links, by_lines: np.ndarray) -> Links:
    """Return links in which light fades.

    Where it does not, factors that lines found are scaled down, from the whole scene to its elements, until the sum for an
    element and all that hold it is 0.98 / rho, with rho the largest reflectance within the element.

    Args:
        by_lines: (m,) bool, which factors may be scaled.
    """
    ranks, reflectance = levels.ranks, levels.hierarchy.patches.reflectance.max(axis=1, keepdims=True)
    lasting = levels.extremes(_left(levels, links, reflectance))[1][ranks.order, 0] > FADES**STEPS
    if not lasting.any():
        return links
    most = FADES / np.maximum(levels.extremes(reflectance)[1][ranks.order, 0], 1e-300)
    rank = ranks.rank[links.receiver]
    total, found = (np.bincount(rank[some], links.factor[some], len(ranks.rank)) for some in (~by_lines, by_lines))
    scale = np.ones(len(total))
    top = slice(0, ranks.levels[0].begin if ranks.levels else len(total))
    for rows, parent in [(top, None), *((slice(level.begin, level.end), level.parent) for level in ranks.levels)]:
        held = total[rows] + (0 if parent is None else total[parent])
        room = np.divide(most[rows] - held, found[rows], out=np.ones(len(held)), where=found[rows] > 0)
        scale[rows] = np.where(lasting[rows], np.clip(room, 0, 1), 1)
        total[rows] = held + scale[rows] * found[rows]
    return Links(links.receiver, links.source, np.where(by_lines, links.factor * scale[rank], links.factor), links.spread)


def _left(levels: Levels, links: Links, reflectance: np.ndarray) -> np.ndarray:
    """Return what is left at patches of light that is 1 everywhere, after some reflections, (n_patches, 1)."""
    exchange, light = Exchange(levels, links), np.ones_like(reflectance)
    for _ in range(STEPS):
        light = reflectance * exchange.gather(light)
    return light
