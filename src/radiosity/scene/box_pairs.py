"""Pairs of boxes that overlap, of two lists."""

from collections.abc import Iterator

import numpy as np

CHUNK = 1 << 20  # pairs at a time


def box_pairs(one: tuple[np.ndarray, np.ndarray], two: tuple[np.ndarray, np.ndarray]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield the numbers of boxes of both lists that overlap or touch, in parts.

    Boxes of the second list are sorted along the axis along which they are smallest for how far they spread. Each box of the
    first is compared with those that may overlap it there.

    Args:
        one, two: lowest and highest corners, (n, 3) and (m, 3).
    """
    (low, high), (from_, to) = one, two
    if not len(low) or not len(from_):
        return
    width = (to - from_).max(axis=0)
    spread = to.max(axis=0) - from_.min(axis=0)
    small = np.divide(width, spread, out=np.ones(3), where=spread > 0)
    axis = int(np.lexsort((-spread, small))[0])
    order = np.argsort(from_[:, axis], kind="stable")
    start = from_[order, axis]
    begin = np.searchsorted(start, low[:, axis] - width[axis], "left")
    many = np.maximum(np.searchsorted(start, high[:, axis], "right") - begin, 0)
    ends, at = np.cumsum(many), 0
    while at < len(low):
        until = max(int(np.searchsorted(ends, (ends[at - 1] if at else 0) + CHUNK, "right")), at + 1)
        row = np.repeat(np.arange(at, until), many[at:until])
        before = ends[at:until] - many[at:until] - (ends[at - 1] if at else 0)
        place = order[begin[row] + np.arange(len(row)) - np.repeat(before, many[at:until])]
        for other in range(3):
            keep = (low[row, other] <= to[place, other]) & (high[row, other] >= from_[place, other])
            row, place = row[keep], place[keep]
        yield row, place
        at = until
