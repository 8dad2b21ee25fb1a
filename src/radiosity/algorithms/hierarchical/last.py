"""The links of the last solution: clusters that receive much answer by their sides, and links with clusters get their values.

Links are no longer divided then. Lines of each link with a cluster find first what it brings. The more it brings, the more lines
it has: the square root of A_r times the irradiance is its part in the squared error, if the lines find it with an error in
proportion to it.
"""

import numpy as np

from .answers import replaced
from .bounds import bounded
from .levels import Levels
from .links import Links
from .making import Maker
from .refine import MOST_LINKS
from .values import Values

LINES = 64  # of a link with clusters, in the mean
LEAST, MOST = 16, 256  # of a link
ANSWERS = 4  # lines of a link of a side
TIMES = 3  # new links of sides, for each link that there was and each side


def last(levels: Levels, maker: Maker, links: Links, radiosity: np.ndarray) -> Links:
    """Return the links of the last solution, sorted.

    Args:
        links: all links, sorted.
        radiosity: (n_elements, n_bands) means over elements, W/m² or lm/m².
    """
    if levels.clusters is None or maker.geometry is None:
        return links
    shine, count = radiosity.sum(axis=1), len(levels.hierarchy)
    sides = shine[levels.hierarchy.first[:-1]]
    volume = np.maximum(links.receiver, links.source) >= count
    flat, links = links.take(~volume), links.take(volume)
    found = _valued(levels, maker, links, shine, sides)
    brought = np.bincount(found.row, weights=found.links.factor * shine[found.links.source], minlength=len(links))
    most = min(TIMES * (len(flat) + len(links) + len(sides)), MOST_LINKS - len(flat) - len(found.links))
    chosen, receiver, source = replaced(levels, links, brought, most)
    dark = np.bincount(found.row, minlength=len(links)) == 0
    kept = links.take(dark & ~chosen)
    parts = [flat, found.links.take(~chosen[found.row]), Links(kept.receiver, kept.source, np.zeros(len(kept)), kept.spread)]
    flat = source < count
    parts.append(maker.plain(receiver[flat], source[flat], ANSWERS))
    nothing = np.zeros(int((~flat).sum()))
    parts.append(maker.valued(Links(receiver[~flat], source[~flat], nothing, nothing), ANSWERS, sides).links)
    links = Links.appended(parts)
    return Links.joined([bounded(levels, links, np.arange(len(links)) >= len(parts[0]))])


def _valued(levels: Levels, maker: Maker, links: Links, shine: np.ndarray, sides: np.ndarray) -> Values:
    """Return what lines find of links, those that bring more with more lines, powers of two."""
    part = np.sqrt(levels.area[links.receiver]) * np.maximum(links.factor, links.spread / 4) * shine[links.source]
    lines = LINES * part / max(part.mean(), 1e-300) if len(part) else part
    lines = np.clip(np.exp2(np.round(np.log2(np.maximum(lines, 1)))), LEAST, MOST).astype(np.int64)
    parts = []
    for rays in np.unique(lines):
        some = np.flatnonzero(lines == rays)
        found = maker.valued(links.take(some), int(rays), sides)
        parts.append(Values(found.links, some[found.row], found.rays))
    return Values.joined(parts)
