"""The matching of triangles in pairs, the best pairs first."""

import numpy as np

ROUNDS = 16  # most rounds of mutual best matching; meshes need two or three


def matched(one: np.ndarray, two: np.ndarray, slots: tuple[np.ndarray, np.ndarray], cost: np.ndarray, n: int) -> np.ndarray:
    """Return which pairs are taken, (k,) int64. In each round a pair is taken where it is the best of both its triangles.

    The best pair is the one of least cost, and of several that with the triangle of the lowest number.

    Args:
        one, two: (m,) the triangles of each pair.
        slots: for each of the two, the place of the pair among those of the triangle, 0 to 2; no two are at one place.
        cost: (m,)
        n: the number of triangles.
    """
    some = np.zeros(n, bool)
    some[one] = some[two] = True
    faces = np.flatnonzero(some)
    row = np.cumsum(some) - 1
    ends = row[one], row[two]
    costs, other = np.full((len(faces), 3), np.inf), np.zeros((len(faces), 3), np.int64)
    pair = np.zeros((len(faces), 3), np.int64)
    for end, across, slot in zip(ends, ends[::-1], slots, strict=True):
        costs[end, slot], other[end, slot], pair[end, slot] = np.round(cost, 6), across, np.arange(len(one))
    left, taken, chosen = np.arange(len(faces)), np.zeros(len(faces), bool), [np.zeros(0, np.int64)]
    best = np.full(len(faces), -1)
    for _ in range(ROUNDS):
        left = left[~taken[left]]
        open_ = np.where(taken[other[left]], np.inf, costs[left])
        least = open_.min(axis=1, initial=np.inf)
        going = np.isfinite(least)
        left, open_, least = left[going], open_[going], least[going]
        if not len(left):
            break
        slot = np.where(open_ == least[:, None], other[left], len(faces)).argmin(axis=1)
        best[left] = pair[left, slot]
        across = other[left, slot]
        mutual = (best[across] == best[left]) & (left < across)
        taken[left[mutual]] = taken[across[mutual]] = True
        chosen.append(best[left[mutual]])
    return np.concatenate(chosen)
