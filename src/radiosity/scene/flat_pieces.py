"""Flat pieces: faces that are joined edge to edge in one plane, as a polygon's triangles and a flat mesh are.

Faces of one piece are beside each other, so they need not be compared to find those that lie on each other.
"""

import numpy as np

AROUND = 4  # faces at an edge that are looked at


def flat_pieces(corners: np.ndarray, normal: np.ndarray, tilt: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return the piece of each face, (n_faces,) int; a face that is joined to none has a number of its own.

    Two faces are joined by an edge which both have, in opposite directions, if their fronts look the same way and no other face
    fits there.

    Args:
        corners: (n_faces, 4, 3), triangles repeat the third.
        normal: (n_faces, 3).
        tilt: (n_faces,) radians.
        faces: (m,) int, the faces to look at.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    place = numbered(corners[faces].reshape(-1, 3)).reshape(-1, 4)
    start, end = place.ravel(), np.roll(place, -1, axis=1).ravel()
    face = np.repeat(faces, 4)
    real = start != end
    face, start, end = face[real], start[real], end[real]
    edge = np.minimum(start, end) * (place.max(initial=0) + 1) + np.maximum(start, end)
    order = np.argsort(edge, kind="stable")
    face, edge, along = face[order], edge[order], (start < end)[order]
    ones, twos = [], []
    for step in range(1, AROUND):
        one, two = np.arange(len(edge) - step), np.arange(step, len(edge))
        fits = (edge[one] == edge[two]) & (along[one] != along[two])
        one, two = one[fits], two[fits]
        same = np.einsum("ij,ij->i", normal[face[one]], normal[face[two]]) > 0
        turned = np.linalg.norm(np.cross(normal[face[one]], normal[face[two]]), axis=1)
        same &= turned <= 2 * (tilt[face[one]] + tilt[face[two]])
        ones.append(one[same])
        twos.append(two[same])
    one, two = np.concatenate(ones), np.concatenate(twos)
    fits = np.bincount(np.concatenate([one, two]), minlength=len(edge))
    alone = (fits[one] == 1) & (fits[two] == 1)
    pairs = face[one[alone]], face[two[alone]]
    count = len(corners)
    return connected_components(coo_array((np.ones(len(pairs[0])), pairs), shape=(count, count)), directed=False)[1]


def numbered(rows: np.ndarray) -> np.ndarray:
    """Return equal numbers for equal rows of float64, by a hash of 64 bits, (n,) int."""
    words = np.ascontiguousarray(rows + 0.0).view(np.uint64)  # no negative zeros
    key = np.zeros(len(rows), np.uint64)
    for column in words.T:
        key = (key ^ column) * np.uint64(0x9E3779B97F4A7C15)
        key ^= key >> np.uint64(29)
    return np.unique(key, return_inverse=True)[1].ravel()
