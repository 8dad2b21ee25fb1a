"""Pairs of triangles with one edge in common, which they run through in opposite directions.

Where few triangles may be halves of a parallelogram (`scene.twins`), only their edges are looked at. Else edges are looked for in
blocks of triangles that follow each other in the file, which stay in the cache: mostly neighbours are near each other there. An
edge between vertices that several blocks use may have triangles in several blocks; such edges are looked for all together. Within
a block each edge is a key: its lower vertex, its upper vertex, and its number in the block. Sorted keys bring the two edges of a
pair together.
"""

from dataclasses import dataclass

import numpy as np

from ..pieces import of_pieces, pieces
from .edges_together import joined, pairs_together
from .measures import Measures
from .one_row import is_one_row
from .triangle_edges import ACROSS, ENDS, Pairs, Triangles, alone, edges_of, in_larger_runs
from .twins import Cells, perhaps_twins

BLOCK = 1 << 13  # triangles
NUMBER, PLACE = np.uint64(16), np.uint64(24)  # bits of an edge's number in its block, and of a vertex, from the block's lowest on
LAST, UPPER = (np.uint64(1) << NUMBER) - np.uint64(1), (np.uint64(1) << PLACE) - np.uint64(1)
MOSTLY = 0.5  # of the corners: where more are vertices of several blocks, all edges are looked for together
DIRECTION = np.array([0.6153, 0.2879, 0.7338]) / np.linalg.norm([0.6153, 0.2879, 0.7338])  # along no axis
ROUNDING = 1e-14  # of the scene's extent: the rounding of sums of places along the direction


def shared_edges(
    vertices: np.ndarray,
    corners: np.ndarray,
    surface: np.ndarray,
    measures: Measures,
    tolerance: float,
    place: np.ndarray | None = None,
    cells: Cells | None = None,
) -> Pairs:
    """Return the edges of pairs of triangles, (m,) int64 each: four times the triangle's row, plus the corner where it begins.

    Only two triangles of the surface have the edge. All parallelograms are among the pairs; of others most are left out.

    Args:
        vertices: (n_vertices, 3) metres.
        corners: (n, 3) int64, vertices of the triangles.
        surface: (n,) int32.
        measures: of the faces, those triangles among them.
        tolerance: of parallelograms, of their longest edge.
        place: (n_vertices,) int64, equal for vertices at the same place (`welded`); None: no two are.
        cells: of the triangles, which are used up; None: all edges are looked at.
    """
    triangles = Triangles(corners, place, surface, [np.ascontiguousarray(axis) for axis in vertices.T], tolerance)
    if cells is not None and (twins := perhaps_twins(triangles, cells)) is not None:
        return _of_some(triangles, twins)
    several, share = _of_several(triangles)
    if share > MOSTLY:
        return pairs_together(triangles, edges_of(np.arange(len(corners))))
    along = np.zeros(len(vertices))
    for axis, middle, part in zip(triangles.axes, measures.bounds.mean(axis=0), DIRECTION, strict=True):
        along += (axis - middle) * part
    extent = float(np.linalg.norm(np.diff(measures.bounds, axis=0)))
    blocks = _Blocks(triangles, several, along, 2 * tolerance * measures.longest + ROUNDING * extent)
    found, apart, several = zip(*of_pieces(blocks.pairs, len(corners), BLOCK), strict=True)
    among = triangles.parallelograms(*triangles.compared(np.concatenate(several)))
    return joined([*found, among, pairs_together(triangles, np.concatenate(apart))])


def _of_some(triangles: Triangles, rows: np.ndarray) -> Pairs:
    """Return the pairs among triangles that may have twins; others may have the same edges."""
    one, two = pairs_together(triangles, edges_of(rows))
    if not len(one):
        return one, two
    ends = np.zeros(len(triangles.axes[0]), bool)
    for vertices in triangles.ends(one):
        ends[vertices] = True

    def between(part: slice) -> np.ndarray:
        """Return the edges whose ends are those of the pairs found, whatever triangles they belong to."""
        is_end = ends.take(triangles.of(part))
        return np.concatenate([4 * (part.start + np.flatnonzero(is_end[k] & is_end[ENDS[k]])) + k for k in range(3)])

    return pairs_together(triangles, np.concatenate(of_pieces(between, len(triangles.corners), BLOCK)))


def _of_several(triangles: Triangles) -> tuple[np.ndarray, float]:
    """Return which vertices several blocks use, (n_vertices,) bool, and the share of corners that are seen to be such ones."""
    corners, n_vertices = triangles.corners, len(triangles.axes[0])
    owner, several, many = np.full(n_vertices, -1, np.int32), np.zeros(n_vertices, bool), 0
    for number, part in enumerate(pieces(len(corners), BLOCK)):
        used = triangles.of(part).ravel()
        before = owner.take(used)
        others = used[(before >= 0) & (before != number)]
        if len(others):
            several[others] = True
            many += len(others)
        owner[used] = number
    return several, many / corners.size if corners.size else 0.0


@dataclass(frozen=True, eq=False)
class _Blocks:
    """Blocks of triangles.

    Attributes:
        triangles: all.
        several: (n_vertices,) bool, which vertices several blocks use.
        along: (n_vertices,) metres, places along a direction.
        most: metres along it, by which the ends of a parallelogram's diagonals are off, at most.
    """

    triangles: Triangles
    several: np.ndarray
    along: np.ndarray
    most: float

    def pairs(self, part: slice) -> tuple[Pairs, np.ndarray, np.ndarray]:
        """Return the pairs of a block, the edges that other blocks may have, too, and those of three triangles and more."""
        corners = self.triangles.of(part)
        size, lowest = corners.shape[1], corners.min()
        place = corners - lowest
        if place.max() >= 1 << int(PLACE):
            every = edges_of(np.arange(part.start, part.stop))
            return (every[:0], every[:0]), every, every[:0]
        keys = _keys(place.view(np.uint64))
        keys.sort()
        follow = np.zeros(len(keys) + 1, bool)
        np.less(keys[1:] ^ keys[:-1], np.uint64(1) << NUMBER, out=follow[1:-1])
        shared = self._shared(keys, lowest)
        first = self._near(np.flatnonzero(alone(follow)), keys, corners)
        first = first[~shared[first]]
        one, two = keys[first], keys[first + 1]
        vertex = corners.ravel()
        opposite = vertex.take((one & LAST).view(np.int64)) != vertex.take((two & LAST).view(np.int64))  # they begin at both ends
        opposite &= one >> (NUMBER + PLACE) != (one >> NUMBER) & UPPER
        larger = in_larger_runs(follow)
        several = np.flatnonzero(larger & ~shared) if larger.any() else first[:0]

        def edges(some: np.ndarray) -> np.ndarray:
            """Return the numbers of edges among all, of keys."""
            number = (some & LAST).view(np.int64)
            corner = (number >= size).astype(np.int8)
            corner += number >= 2 * size
            number -= np.take(np.arange(3) * size, corner)
            number += part.start
            number <<= 2
            number += corner
            return number

        one, two = edges(one[opposite]), edges(two[opposite])
        if not is_one_row(self.triangles.surface):
            same = self.triangles.surface[one >> 2] == self.triangles.surface[two >> 2]
            one, two = one[same], two[same]
        return (one, two), edges(keys[shared]), edges(keys[several])

    def _shared(self, keys: np.ndarray, lowest: int) -> np.ndarray:
        """Return which sorted keys are of edges that other blocks may have, too, bool."""
        several = self.several[lowest:]
        result = several.take((keys >> (NUMBER + PLACE)).view(np.int64))
        some = np.flatnonzero(result)
        result[some] = several.take(((keys[some] >> NUMBER) & UPPER).view(np.int64))
        return result

    def _near(self, first: np.ndarray, keys: np.ndarray, corners: np.ndarray) -> np.ndarray:
        """Return those pairs, keys that follow each other, whose triangles are nearly the halves of a parallelogram."""
        places = self.along.take(corners)
        across = places.take(ACROSS, axis=0)
        expected = (places.sum(axis=0) - 2 * across).ravel()
        one, two = keys[first] & LAST, keys[first + 1] & LAST
        off = expected.take(one.view(np.int64))
        off -= across.ravel().take(two.view(np.int64))
        return first[np.abs(off, out=off) <= self.most]


def _keys(place: np.ndarray) -> np.ndarray:
    """Return the keys of the edges of triangles, (3 n,) uint64, of the vertices at their corners, (3, n)."""
    upper, size = place << NUMBER, place.shape[1]
    lower = upper << PLACE
    keys, high = np.empty((3, size), np.uint64), np.empty(size, np.uint64)
    for k in range(3):
        np.minimum(lower[k], lower[ENDS[k]], out=keys[k])
        keys[k] |= np.maximum(upper[k], upper[ENDS[k]], out=high)
    keys = keys.ravel()
    keys |= np.arange(3 * size, dtype=np.uint64)
    return keys
