"""Flat pieces: faces that are joined edge to edge in one plane, as a polygon's triangles and a flat mesh are.

Faces of one piece are beside each other, so they need not be compared to find those that lie on each other.
"""

import numpy as np

from ..pieces import of_pieces
from .equal_keys import grouped
from .measures import cross, length

AROUND = 4  # faces at an edge that are looked at
SIZE = 1 << 14  # edges at a time


def flat_pieces(place: np.ndarray, normal: np.ndarray, tilt: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return the piece of each face, (n_faces,) int; a face that is joined to none has a number of its own.

    Two faces are joined by an edge which both have, in opposite directions, if their fronts look the same way and no other face
    fits there.

    Args:
        place: (n_faces, 4) int64, equal for corners at the same place, and only there; triangles repeat the third.
        normal: (n_faces, 3).
        tilt: (n_faces,) radians.
        faces: (m,) int, the faces to look at.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    some = place[faces]
    start, end = some.ravel(), some[:, [1, 2, 3, 0]].ravel()
    real = np.flatnonzero(start != end)
    start, end = start[real], end[real]
    edge = np.minimum(start, end) * (int(place.max(initial=0)) + 1) + np.maximum(start, end)
    order = grouped(edge)
    face, edge, along = faces[real[order] >> 2], edge[order], (start < end)[order]
    axes = [np.ascontiguousarray(axis) for axis in normal.T]

    def joined(part: slice) -> tuple[np.ndarray, np.ndarray]:
        """Return which edges from those of a part on, and of the few that follow each, join their faces."""
        found = []
        for step in range(1, AROUND):
            stop = min(part.stop, len(edge) - step)
            here, after = slice(part.start, stop), slice(part.start + step, max(stop, part.start) + step)
            one = part.start + np.flatnonzero((edge[here] == edge[after]) & (along[here] != along[after]))
            first, second = face[one], face[one + step]
            a, b = ([axis.take(which) for axis in axes] for which in (first, second))
            same = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0
            same &= length(cross(a, b)) <= 2 * (tilt[first] + tilt[second])
            found.append((one[same], one[same] + step))
        ones, twos = zip(*found, strict=True)
        return np.concatenate(ones), np.concatenate(twos)

    found = [(face[:0], face[:0]), *of_pieces(joined, len(edge), SIZE)]
    one, two = (np.concatenate(part) for part in zip(*found, strict=True))
    fits = np.bincount(np.concatenate([one, two]), minlength=len(edge))
    alone = (fits[one] == 1) & (fits[two] == 1)
    pairs = face[one[alone]], face[two[alone]]
    count = len(place)
    return connected_components(coo_array((np.ones(len(pairs[0])), pairs), shape=(count, count)), directed=False)[1]


def numbered(rows: np.ndarray) -> np.ndarray:
    """Return equal numbers for equal rows of float64, by a hash of 64 bits, (n,) int."""
    words = np.ascontiguousarray(rows + 0.0).view(np.uint64)  # no negative zeros
    key = np.zeros(len(rows), np.uint64)
    for column in words.T:
        key = (key ^ column) * np.uint64(0x9E3779B97F4A7C15)
        key ^= key >> np.uint64(29)
    return np.unique(key, return_inverse=True)[1].ravel()
