"""Triangles that may be one half of a parallelogram: some other one has the same edges, turned by half a circle.

Then both have the same longest edge and the same cross product of edges. So triangles are put into cells of these, and one that
is alone in its cell, and not near a side of it, has no twin. Most triangles of curved meshes are found alone, which takes less
time than to look for those that share their edges.
"""

import numpy as np

from ..pieces import of_pieces
from .edges_together import pairs_together
from .equal_keys import follows, mixed, sort
from .measures import cross, largest_squared, minus
from .triangle_edges import Triangles, edges_of

SIZE = 1 << 13  # triangles of a piece
BITS = 12  # a cell is 2^-12 of the square of the longest edge, taken down to a power of two
WITHIN = 3.0  # tolerances of parallelograms, by which twins may differ, and some more
MANTISSA = 23  # bits of single precision, which edges have here: it is finer than the tolerance
SAMPLE = 16  # pieces, which tell whether it is worthwhile
MOSTLY = 0.3  # of the triangles may have a twin: then the edges of all are looked at,
ALIKE, FEW = 0.6, 0.05  # unless no more than these are alike, and have one: slivers are alike, which have none


def perhaps_twins(triangles: Triangles) -> np.ndarray | None:
    """Return the rows of triangles that may have a twin, in order; None where it was seen that many may have one."""
    n = len(triangles.corners)
    if n > SAMPLE * SIZE:
        step = n // SAMPLE
        parts = [slice(begin, begin + SIZE) for begin in range(0, step * SAMPLE, step)]
        some = [part.start + np.flatnonzero(_alike(*_cells(triangles, part))) for part in parts]
        alike = sum(map(len, some)) / (SAMPLE * SIZE)
        if alike > ALIKE or (alike > MOSTLY and _halves(triangles, some) > FEW):
            return None
    keys, near = np.empty(n, np.uint64), np.empty(n, bool)

    def make(part: slice) -> None:
        keys[part], near[part] = _cells(triangles, part)

    of_pieces(make, n, SIZE)
    return np.flatnonzero(_alike(keys, near))


def _halves(triangles: Triangles, some: list[np.ndarray]) -> float:
    """Return the share of triangles that are halves of a parallelogram, of pieces whose rows that are alike are given."""
    pairs = [pairs_together(triangles, edges_of(rows))[0] for rows in some]
    return 2 * sum(map(len, pairs)) / (len(some) * SIZE)


def _cells(triangles: Triangles, part: slice) -> tuple[np.ndarray, np.ndarray]:
    """Return a hash of each triangle's cell, (m,) uint64, and which triangles are so near a side that twins may be beyond it."""
    corners = [[axis.take(column) for axis in triangles.axes] for column in np.ascontiguousarray(triangles.corners[part].T)]
    along, up = ([axis.astype(np.float32) for axis in minus(corner, corners[0])] for corner in corners[1:])
    longest = largest_squared(along, up).view(np.int32)
    within = WITHIN * triangles.tolerance
    exponent = np.maximum(longest >> MANTISSA, BITS + 1)
    scale = ((254 + BITS - exponent) << MANTISSA).view(np.float32)  # 2^BITS over the power of two
    rest, one = longest & ((1 << MANTISSA) - 1), 1 << MANTISSA
    near = (rest < int(2 * within * one)) | (rest > int((1 - within) * one))
    key = exponent.astype(np.int64)
    for product in cross(along, up):
        product *= scale
        cell = np.rint(product)
        product -= cell
        near |= np.abs(product, out=product) > 0.5 - within * 2**BITS
        key <<= BITS + 3
        key += cell.astype(np.int64)
    return mixed(key.view(np.uint64)), near


def _alike(keys: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Return which triangles are not alone in their cell, or near a side of it, (n,) bool."""
    bits = max(len(keys) - 1, 1).bit_length()
    low = np.uint64((1 << bits) - 1)
    numbered = (keys & ~low) | np.arange(len(keys), dtype=np.uint64)
    sort(numbered)
    follow = follows(numbered, bits)
    result = near.copy()
    result[(numbered[follow[:-1] | follow[1:]] & low).view(np.int64)] = True
    return result
