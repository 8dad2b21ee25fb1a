"""Pairs of triangles with one edge in common, which they run through in opposite directions.

Each edge is a key: its lower vertex, some bits of its upper vertex and of its surface, and its number, which is four times the
row of the triangle plus the corner at which the edge begins. Sorted keys bring the two edges of a pair together.
"""

import numpy as np

from ..pieces import of_pieces
from .equal_keys import MIX, follows, sort
from .measures import Measures, length, minus

LEAST_BITS = 8  # of a key, for the upper vertex and the surface
ENDS = (1, 2, 0)  # the corner where the edge ends that begins at each corner
ACROSS = (2, 0, 1)  # the corner that is not on it
DIRECTION = np.array([0.6153, 0.2879, 0.7338]) / np.linalg.norm([0.6153, 0.2879, 0.7338])  # along no axis
ROUNDING = 6e-7  # of the scene's extent, where places along the direction are single precision


def shared_edges(
    vertices: np.ndarray, corners: np.ndarray, surface: np.ndarray, measures: Measures, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges of pairs of triangles, (m,) int64 each: four times the triangle's row, plus the corner where it begins.

    Only two triangles of the surface have the edge. All parallelograms are among the pairs; of others most are left out.

    Args:
        vertices: (n_vertices, 3) metres.
        corners: (n, 3) int64, vertices of the triangles; equal numbers for equal places.
        surface: (n,) int32.
        measures: of the faces, those triangles among them.
        tolerance: of parallelograms, of their longest edge.
    """
    bits = max(4 * len(corners) - 1, 1).bit_length()
    keys, heights = np.empty((len(corners), 3), np.uint64), np.empty((len(corners), 4), np.float32)
    spare = 64 - bits - max(int(corners.max(initial=1)), 1).bit_length()
    if spare < LEAST_BITS:
        return _exactly(corners, surface, np.arange(4 * len(corners)).reshape(-1, 4)[:, :3].ravel())
    axes = [np.ascontiguousarray(axis) for axis in vertices.T]
    along = np.zeros(len(vertices))
    for axis, middle, share in zip(axes, measures.bounds.mean(axis=0), DIRECTION, strict=True):
        along += (axis - middle) * share
    salt, shift, top = np.uint64(MIX << 1 | 1), np.uint64(64 - spare), np.uint64(bits + spare)

    def make(part: slice) -> None:
        some = corners[part].T.astype(np.uint64)
        place = [along[corners[part, k]] for k in range(3)]
        heights[part, 3] = place[0] + place[1] + place[2]
        number = np.arange(4 * part.start, 4 * part.stop, 4, dtype=np.uint64)
        salted = surface[part].astype(np.uint64) * salt
        for k in range(3):
            heights[part, k] = place[ACROSS[k]]
            one, two = some[k], some[ENDS[k]]
            rest = ((np.maximum(one, two) + salted) * MIX) >> shift
            keys[part, k] = (np.minimum(one, two) << top) | (rest << np.uint64(bits)) | (number + np.uint64(k))

    of_pieces(make, len(corners))
    keys, heights = keys.ravel(), heights.ravel()
    sort(keys)
    low, follow = np.uint64((1 << bits) - 1), follows(keys, bits)
    most = 2 * tolerance * measures.longest + ROUNDING * float(np.linalg.norm(np.diff(measures.bounds, axis=0)))

    def find(part: slice) -> tuple[np.ndarray, ...]:
        here, after = follow[part], follow[part.start + 1 : part.stop + 1]
        last = np.append(follow[part.start + 2 : part.stop + 1], False if part.stop == len(keys) else follow[part.stop + 1])
        first = part.start + np.flatnonzero(~here & after & ~last)
        one, two = ((keys[first + i] & low).astype(np.int64) for i in (0, 1))
        fits = np.abs(heights[one | 3] - 2 * heights[one] - heights[two]) <= most
        one, two = one[fits], two[fits]
        same = _same(corners, surface, one, two)
        one, two = one[same], two[same]
        a, b, c, d = (
            [axis[ends] for axis in axes] for ends in (*_ends(corners, one), _across(corners, one), _across(corners, two))
        )
        longest = np.maximum(
            np.maximum(length(minus(a, c)), length(minus(b, c))), np.maximum(length(minus(a, d)), length(minus(b, d)))
        )
        near = length(minus(minus(a, c), minus(d, b))) <= 2 * tolerance * longest
        return one[near], two[near]

    found = [(np.zeros(0, np.int64),) * 2, *of_pieces(find, len(keys))]
    several = follow[:-1] & follow[1:]  # in the middle of three and more
    if several.any():
        near = several.copy()
        near[1:] |= several[:-1]
        near[:-1] |= several[1:]
        found.append(_exactly(corners, surface, (keys[near] & low).astype(np.int64)))
    return np.concatenate([one for one, _ in found]), np.concatenate([two for _, two in found])


def _ends(corners: np.ndarray, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices where edges begin and end."""
    row, corner = edge >> 2, edge & 3
    return corners[row, corner], corners[row, np.take(ENDS, corner)]


def _across(corners: np.ndarray, edge: np.ndarray) -> np.ndarray:
    """Return the vertices across from edges."""
    return corners[edge >> 2, np.take(ACROSS, edge & 3)]


def _same(corners: np.ndarray, surface: np.ndarray, one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """Return which edges are run through in opposite directions, by triangles of one surface."""
    (start, end), (begin, stop) = _ends(corners, one), _ends(corners, two)
    return (start == stop) & (end == begin) & (start != end) & (surface[one >> 2] == surface[two >> 2])


def _exactly(corners: np.ndarray, surface: np.ndarray, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs among some edges, all of which are given that have the same ends."""
    start, end = _ends(corners, edge)
    columns = np.minimum(start, end), np.maximum(start, end), surface[edge >> 2]
    order = np.lexsort(columns)
    same = np.all([column[order][1:] == column[order][:-1] for column in columns], axis=0)
    same = np.concatenate([[False], same, [False]])
    first = np.flatnonzero(~same[:-1] & same[1:] & ~np.append(same[2:], False))
    one, two = edge[order[first]], edge[order[first + 1]]
    opposite = _same(corners, surface, one, two)
    return one[opposite], two[opposite]
