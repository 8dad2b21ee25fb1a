"""Repeats: an edge that passes the same place of a repeating image several times is followed once, and counted as often."""

from math import gcd

import numpy as np

HIGHEST = 8  # periods along either axis after which an edge is looked for to come back
TOLERANCE = 2e-6  # of an edge's length, that it may miss its place by: what single precision coordinates can hold
FRACTIONS = np.array(sorted({(p / q, p, q) for q in range(1, HIGHEST + 1) for p in range(q + 1) if gcd(p, q) == 1}))


def folded(start: np.ndarray, edge: np.ndarray, period: tuple[float, float], width: np.ndarray):
    """Return the edges to follow: starts, vectors, how often each counts, and the number of the edge that it stands for.

    The last value is, for each given edge, the periods that it runs over if its direction repeats, or infinity, (m,).

    Args:
        start, edge: (m, 2), in texels.
        period: the periods along x and y, in texels.
        width: (m,) widths of the footprints across the edge; narrow ones stay as they are.
    """
    along = np.abs(edge) / period
    longer = along.max(axis=1)
    ratio = along.min(axis=1) / np.maximum(longer, 1e-300)
    at = np.clip(np.searchsorted(FRACTIONS[:, 0], ratio), 1, len(FRACTIONS) - 1)
    at -= ratio - FRACTIONS[at - 1, 0] < FRACTIONS[at, 0] - ratio
    miss = np.abs(ratio - FRACTIONS[at, 0]) * longer * max(period)
    times = np.floor(longer / FRACTIONS[at, 2])
    back = (np.abs(ratio - FRACTIONS[at, 0]) < TOLERANCE) & (ratio > 0)
    fits = back & (miss * HIGHEST < width) & (times >= 2)
    again, other = np.flatnonzero(fits), np.flatnonzero(~fits)
    once = edge[again] * (FRACTIONS[at, 2] / np.maximum(longer, 1e-300))[again, None]
    many = times[again, None]
    starts = [start[other], start[again], start[again] + once * many]
    edges = [edge[other], once, edge[again] - once * many]
    count = [np.ones(len(other)), times[again], np.ones(len(again))]
    which = np.concatenate([other, again, again])
    return np.concatenate(starts), np.concatenate(edges), np.concatenate(count), which, np.where(back, longer, np.inf)
