"""The matching of triangles in pairs, the best pairs first."""

import numpy as np

from ..pieces import of_pieces

SIZE = 1 << 14  # triangles at a time
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
    faces = int(np.count_nonzero(some))
    row = np.cumsum(some, dtype=np.int32) - 1
    ends = row[one], row[two]
    rounded = np.round(cost, 6)
    costs, other, pair = np.full(3 * faces, np.inf), np.zeros(3 * faces, np.int32), np.zeros(3 * faces, np.int64)
    for end, across, slot in zip(ends, ends[::-1], slots, strict=True):
        place = slot * faces + end
        costs[place], other[place], pair[place] = rounded, across, np.arange(len(one))
    costs, other, pair = (values.reshape(3, faces) for values in (costs, other, pair))
    left, taken, chosen = np.arange(faces), np.zeros(faces, bool), [np.zeros(0, np.int64)]
    best, partner = np.full(faces, -1), np.zeros(faces, np.int32)

    def look(part: slice) -> np.ndarray:
        """Find the best open pair of some triangles, and return those that have one."""
        rows = left[part]
        least, first = np.full(len(rows), np.inf), np.full(len(rows), faces, np.int32)
        number = np.full(len(rows), -1)
        for k in range(3):
            across, price = other[k].take(rows), costs[k].take(rows)
            price[taken.take(across)] = np.inf
            better = (price < least) | ((price == least) & (across < first) & np.isfinite(price))
            least, first = np.where(better, price, least), np.where(better, across, first)
            number = np.where(better, pair[k].take(rows), number)
        going = number >= 0
        rows = rows[going]
        best[rows], partner[rows] = number[going], first[going]
        return rows

    def agree(part: slice) -> np.ndarray:
        """Return the triangles whose best pair is also the best one of the other, once each."""
        rows = left[part]
        across = partner.take(rows)
        return rows[(best.take(across) == best.take(rows)) & (rows < across)]

    for _ in range(ROUNDS):
        left = np.concatenate([left[:0], *of_pieces(look, len(left), SIZE)])
        if not len(left):
            break
        mutual = np.concatenate(of_pieces(agree, len(left), SIZE))
        taken[mutual] = taken[partner[mutual]] = True
        chosen.append(best[mutual])
        left = left[~taken[left]]
    return np.concatenate(chosen)
