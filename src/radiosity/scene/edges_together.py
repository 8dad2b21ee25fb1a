"""Pairs of edges among any edges of a mesh, wherever their triangles stand in the file.

Each edge is a key: its lower vertex, some bits of its upper vertex and of its surface, and its number. Sorted keys bring the two
edges of a pair together.
"""

import numpy as np

from ..pieces import of_pieces
from .equal_keys import MIX, follows, sort
from .triangle_edges import Pairs, Triangles, alone, in_larger_runs

LEAST_BITS = 8  # of a key, for the upper vertex and the surface


def pairs_together(triangles: Triangles, edge: np.ndarray) -> Pairs:
    """Return the pairs of some edges, (m,) int64 numbers, with halves of a parallelogram. All of the same ends are given."""
    bits = max(4 * len(triangles.corners) - 1, 1).bit_length()
    spare = 64 - bits - max(len(triangles.axes[0]) - 1, 1).bit_length()
    if spare < LEAST_BITS:
        return triangles.parallelograms(*triangles.compared(edge))
    keys = np.empty(len(edge), np.uint64)
    salt, shift, top = np.uint64(MIX << 1 | 1), np.uint64(64 - spare), np.uint64(bits + spare)

    def make(part: slice) -> None:
        one, two = triangles.ends(edge[part])
        rest = np.maximum(one, two).astype(np.uint64)
        rest += triangles.surface[edge[part] >> 2].astype(np.uint64) * salt
        rest *= MIX
        rest >>= shift
        keys[part] = np.minimum(one, two).astype(np.uint64) << top
        keys[part] |= rest << np.uint64(bits)
        keys[part] |= edge[part].view(np.uint64)

    of_pieces(make, len(edge))
    sort(keys)
    low, follow = np.uint64((1 << bits) - 1), follows(keys, bits)

    def find(part: slice) -> Pairs:
        first = part.start + np.flatnonzero(alone(follow[part.start : part.stop + 2])[: part.stop - part.start])
        one, two = ((keys[first + i] & low).view(np.int64) for i in (0, 1))
        return triangles.parallelograms(*triangles.opposite(one, two))

    found = of_pieces(find, len(keys))
    several = in_larger_runs(follow)
    if several.any():
        found.append(triangles.parallelograms(*triangles.compared((keys[several] & low).view(np.int64))))
    return joined(found)


def joined(found: list[Pairs]) -> Pairs:
    """Return pairs one after another."""
    one, two = (np.concatenate([np.zeros(0, np.int64), *part]) for part in zip(*found, strict=True)) if found else ([], [])
    return np.asarray(one, np.int64), np.asarray(two, np.int64)
