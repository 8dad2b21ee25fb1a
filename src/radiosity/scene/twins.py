"""Triangles that may be one half of a parallelogram: some other one has the same edges, turned by half a circle.

Then both have the same longest edge and the same cross product of edges. So triangles are put into cells of these while they are
measured, and one that is alone in its cell, and not near a side of it, has no twin. Most triangles of curved meshes are found
alone, which takes less time than to look for those that share their edges.
"""

from dataclasses import dataclass

import numpy as np

from .edges_together import pairs_together
from .equal_keys import follows, mixed, sort
from .measures import Vectors, measured
from .triangle_edges import Triangles, edges_of

SIZE = 1 << 13  # triangles of a piece
BITS = 12  # a cell is 2^-12 of the square of the longest edge, taken down to a power of two
WITHIN = 3.0  # tolerances of parallelograms, by which twins may differ, and some more
MANTISSA = 23  # bits of single precision, which is finer than the tolerance
SAMPLE = 16  # pieces, which tell whether it is worthwhile
FIRST = 1 << 11  # triangles of a piece of a first sample, which spares the cells of all
MOSTLY = 0.3  # of the triangles may have a twin: then the edges of all are looked at,
ALIKE, FEW = 0.6, 0.05  # unless no more than these are alike, and have one: slivers are alike, which have none


@dataclass(eq=False)
class Cells:
    """The cells of faces; those of parallelograms mean nothing.

    Attributes:
        tolerance: of parallelograms, of their longest edge.
        keys: (n,) uint64, a hash of each face's cell.
        near: (n,) bool, which are so near a side of their cell that a twin may be beyond it.
    """

    tolerance: float
    keys: np.ndarray
    near: np.ndarray

    @classmethod
    def empty(cls, count: int, tolerance: float) -> "Cells":
        """Return cells of so many faces, to be put in."""
        return cls(tolerance, np.empty(count, np.uint64), np.empty(count, bool))

    def put(self, part: slice, normal: Vectors, squared: np.ndarray) -> None:
        """Find the cells of some faces, of the cross product of two edges, and the square of the longest; see `measured`."""
        longest = squared.astype(np.float32).view(np.int32)
        within = WITHIN * self.tolerance
        exponent = np.maximum(longest >> MANTISSA, BITS + 1)
        scale = ((254 + BITS - exponent) << MANTISSA).view(np.float32)  # 2^BITS over the power of two
        rest, one = longest & ((1 << MANTISSA) - 1), 1 << MANTISSA
        near = (rest < int(2 * within * one)) | (rest > int((1 - 2 * within) * one))
        key = exponent.astype(np.int64)
        for axis in normal:
            product = axis.astype(np.float32)
            product *= scale
            cell = np.rint(product)
            product -= cell
            near |= np.abs(product, out=product) > 0.5 - within * 2**BITS
            key <<= BITS + 3
            key += cell.astype(np.int64)
        self.keys[part], self.near[part] = mixed(key.view(np.uint64)), near

    def take(self, rows: np.ndarray | slice) -> "Cells":
        """Return the cells of some faces."""
        return Cells(self.tolerance, self.keys[rows], self.near[rows])

    def alike(self) -> np.ndarray:
        """Return the rows of faces that are not alone in their cell, or near a side of it, in order. Keys are used up."""
        bits = max(len(self.keys) - 1, 1).bit_length()
        low = np.uint64((1 << bits) - 1)
        numbered, self.keys = self.keys, self.keys[:0]
        numbered &= ~low
        numbered |= np.arange(len(numbered), dtype=np.uint64)
        sort(numbered)
        follow = follows(numbered, bits)
        result = self.near.copy()
        result[(numbered[follow[:-1] | follow[1:]] & low).view(np.int64)] = True
        return np.flatnonzero(result)


def mostly_alike(vertices: np.ndarray, faces: np.ndarray, tolerance: float) -> bool:
    """Return whether a sample of the triangles among faces, (n, 4), says that cells of all are not worthwhile."""
    alike = among = 0
    for begin in range(0, len(faces), max(len(faces) // SAMPLE, FIRST)):
        some = faces[begin : begin + FIRST]
        corners = vertices[some[some[:, 3] < 0, :3]].reshape(-1, 3)
        count = len(corners) // 3
        if count:
            cells = Cells.empty(count, tolerance)
            measured(corners, np.column_stack([np.arange(3 * count).reshape(-1, 3), np.full(count, -1)]), cells.put)
            alike, among = alike + len(cells.alike()), among + count
    return alike > ALIKE * among


def perhaps_twins(triangles: Triangles, cells: Cells) -> np.ndarray | None:
    """Return the rows of triangles that may have a twin, in order; None where it was seen that many may have one.

    Args:
        cells: of the triangles; they are used up.
    """
    n = len(triangles.corners)
    if n > SAMPLE * SIZE:
        step = n // SAMPLE
        parts = [slice(begin, begin + SIZE) for begin in range(0, step * SAMPLE, step)]
        some = [part.start + Cells(cells.tolerance, cells.keys[part].copy(), cells.near[part]).alike() for part in parts]
        alike = sum(map(len, some)) / (SAMPLE * SIZE)
        if alike > ALIKE or (alike > MOSTLY and _halves(triangles, some) > FEW):
            return None
    return cells.alike()


def _halves(triangles: Triangles, some: list[np.ndarray]) -> float:
    """Return the share of triangles that are halves of a parallelogram, of pieces whose rows that are alike are given."""
    pairs = [pairs_together(triangles, edges_of(rows))[0] for rows in some]
    return 2 * sum(map(len, pairs)) / (len(some) * SIZE)
