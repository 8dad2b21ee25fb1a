"""Pairs of faces that may lie on each other: near in space, and in planes that are near where they meet.

Faces are put into grids of cubes, one grid for each power of four, whose cubes are as large as the faces of that size. Within a
cube they are put into slabs by the distance of their planes from its middle. Each face is compared with those of its own size
and larger that share a cube and a slab with it. So a wall is not compared with all faces before it, nor a fine mesh with all of
itself.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .equal_keys import together

SQUARE = 0.7  # below sqrt(1/2)
STEP = 2  # binary logarithm of the ratio of one grid to the next
SLABS = 64  # slabs of a cube
LOW = 26  # bits at the end of keys that are zero, so that sorted keys may carry their number there
FILTER = 22  # first bits of keys: they find most keys that no other face shares
CHUNK = 1 << 19  # faces, and pairs, at a time
PRIMES = (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x27D4EB2F165667C5)


@dataclass(frozen=True, eq=False)
class Plates:
    """Flat convex pieces.

    Attributes:
        low, high: (n, 3) the corners of their boxes.
        normal, centroid: (n, 3).
        tilt: (n,) radians, the uncertainty of normals.
        margin: (n,) the uncertainty of planes and places.
        width: (n,) the least width of an overlap with this plate.
        piece: (n,) int: plates of one piece are not compared.
    """

    low: np.ndarray
    high: np.ndarray
    normal: np.ndarray
    centroid: np.ndarray
    tilt: np.ndarray
    margin: np.ndarray
    width: np.ndarray
    piece: np.ndarray


def pairs(plates: Plates, some: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield pairs of some plates (indices) whose boxes and planes may meet, in parts: (m,) indices of the smaller and the larger.

    Some pairs come twice.
    """
    size = np.maximum((plates.high - plates.low).max(axis=1) + 2 * plates.margin, 1e-300)
    level = STEP * np.ceil(np.log2(size) / STEP).astype(np.int64)
    for at in np.unique(level[some]):
        cube = 2.0**at
        entries = face, cell, keys = _entries(plates, some[level[some] == at], cube)
        order = together(keys) if len(keys) < 1 << LOW else np.argsort(keys)
        larger = _Groups.of(face[order], cell.take(order, axis=1), keys[order], plates.piece)
        yield from _matches(plates, entries, level, larger)
        smaller = some[level[some] < at]
        for begin in range(0, len(smaller), CHUNK):
            yield from _matches(plates, _entries(plates, smaller[begin : begin + CHUNK], cube), level, larger)


def _entries(plates: Plates, face: np.ndarray, cube: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the cubes and slabs of each face, with an entry for each: face, cube (3, k) and key."""
    margin = plates.margin[face][:, None]
    low = np.floor((plates.low[face] - margin) / cube).astype(np.int64)
    wide = np.floor((plates.high[face] + margin) / cube).astype(np.int64) > low
    rows, cells = [], []
    for step in np.ndindex(2, 2, 2):
        here = np.flatnonzero(_each([column if more else True for column, more in zip(wide.T, step, strict=True)], len(face)))
        rows.append(here)
        cells.append(low[here].T + np.array(step)[:, None])
    row, cell = np.concatenate(rows), np.concatenate(cells, axis=1)
    face = face[row]
    distance = np.zeros(len(face))
    for centroid, normal, here in zip(plates.centroid.T, plates.normal.T, cell, strict=True):
        middle = here + 0.5
        middle *= -cube
        middle += centroid[face]
        middle *= normal[face]
        distance += middle
    distance = np.abs(distance, out=distance)
    unsure = plates.tilt[face] * cube + plates.margin[face]
    slab = cube / SLABS
    # rounded, so that planes of round coordinates lie in the middle of a slab
    first = np.clip(np.rint((distance - unsure) / slab), 0, SLABS).astype(np.int64)
    last = np.clip(np.rint((distance + unsure) / slab), 0, SLABS).astype(np.int64)
    many = last - first + 1
    at = np.repeat(np.arange(len(face)), many)
    number = first[at] + np.arange(len(at)) - np.repeat(np.cumsum(many) - many, many)
    factors = np.array(PRIMES, np.uint64)
    keys = cell[0].view(np.uint64) * factors[0]  # a hash: pairs that share it by chance are removed below
    for axis in (1, 2):
        keys += cell[axis].view(np.uint64) * factors[axis]
    keys = keys[at]
    keys += number.view(np.uint64) * factors[3]
    keys ^= keys >> np.uint64(29)
    keys *= factors[0]
    keys &= ~np.uint64((1 << LOW) - 1)
    return face[at], cell.take(at, axis=1), keys


def _each(conditions, count: int) -> np.ndarray:
    """Return whether all conditions of a row hold; column by column, which is faster than along short rows."""
    result = np.ones(count, bool)
    for condition in conditions:
        result &= condition
    return result


@dataclass(frozen=True, eq=False)
class _Groups:
    """Entries of faces in groups of one key.

    Attributes:
        face, cell: (k,), (3, k) of each entry.
        key, begin, end: (m,) of each group, in order: its key, its first entry, and the one after its last.
        lowest, highest: (m,) of the pieces of its faces.
        taken: which hashes of keys there are.
    """

    face: np.ndarray
    cell: np.ndarray
    key: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    lowest: np.ndarray
    highest: np.ndarray
    taken: np.ndarray

    @staticmethod
    def of(face: np.ndarray, cell: np.ndarray, keys: np.ndarray, piece: np.ndarray) -> "_Groups":
        """Return groups of entries with sorted keys, (k,), equal ones beside each other."""
        begin = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]]))
        lowest, highest = (reduce.reduceat(piece[face], begin) for reduce in (np.minimum, np.maximum))
        taken = np.zeros(1 << FILTER, bool)
        taken[(keys[begin] >> np.uint64(64 - FILTER)).view(np.int64)] = True
        return _Groups(face, cell, keys[begin], begin, np.append(begin[1:], len(keys)), lowest, highest, taken)

    def find(self, keys: np.ndarray) -> np.ndarray:
        """Return the group of each key, or of the next higher key; searched in order of the keys, which keeps to the cache."""
        order = together(keys)
        result = np.empty(len(keys), np.int64)
        result[order] = np.minimum(np.searchsorted(self.key, keys[order]), len(self.key) - 1)
        return result


def _matches(
    plates: Plates, entries: tuple[np.ndarray, np.ndarray, np.ndarray], level: np.ndarray, larger: _Groups
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    face, cell, keys = entries
    shared = np.flatnonzero(larger.taken.take((keys >> np.uint64(64 - FILTER)).view(np.int64)))
    face, cell, keys = face[shared], cell.take(shared, axis=1), keys[shared]
    group = larger.find(keys)
    # where all faces of a key are of the plate's own piece there is nothing to compare
    own = plates.piece[face]
    met = np.flatnonzero((larger.key[group] == keys) & ((larger.lowest[group] != own) | (larger.highest[group] != own)))
    face, cell, begin, many = face[met], cell.take(met, axis=1), larger.begin[group[met]], (larger.end - larger.begin)[group[met]]
    ends = np.cumsum(many)
    at = 0
    while at < len(face):
        until = max(int(np.searchsorted(ends, (ends[at - 1] if at else 0) + CHUNK, "right")), at + 1)
        part = slice(at, until)
        row = np.repeat(np.arange(at, until), many[part])
        place = begin[row] + np.arange(len(row)) - np.repeat(ends[part] - many[part] - (ends[at - 1] if at else 0), many[part])
        one, two = face[row], larger.face[place]
        keep = ((level[one] < level[two]) | (one < two)) & (plates.piece[one] != plates.piece[two])
        keep &= _each((cell[axis, row] == larger.cell[axis, place] for axis in range(3)), len(row))
        row, one, two = row[keep], one[keep], two[keep]
        low = [np.maximum(plates.low[one, axis], plates.low[two, axis]) for axis in range(3)]
        high = [np.minimum(plates.high[one, axis], plates.high[two, axis]) for axis in range(3)]
        margin, width = plates.margin[one] + plates.margin[two], SQUARE * plates.width[one]
        keep = _each((h - lo >= -margin for lo, h in zip(low, high, strict=True)), len(row))
        # along two axes at least a plane region is as wide as half the root of two of its width
        keep &= sum((h - lo > width).astype(np.int8) for lo, h in zip(low, high, strict=True)) >= 2
        yield one[keep], two[keep]
        at = until
