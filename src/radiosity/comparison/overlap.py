"""Which cells of two meshes of the same faces overlap, and where: their common refinement."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..pieces import pieces
from .clipping import areas, intersections

NOTHING = 1e-9  # of the smaller of two cells: cells that share less have an edge in common at most


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of a mesh.

    Attributes:
        polygons: (n, 4, 2) corners in the plane of their face, metres, counterclockwise; a triangle repeats its last one.
        face: (n,) int64, the whole face that each lies in.
    """

    polygons: np.ndarray
    face: np.ndarray


@dataclass(frozen=True, eq=False)
class Overlaps:
    """What pairs of cells have in common.

    Attributes:
        first, second: (m,) int64, the cells of each mesh.
        polygons: (m, k, 2) what they have in common; the last corner is repeated.
    """

    first: np.ndarray
    second: np.ndarray
    polygons: np.ndarray


def overlaps(first: Cells, second: Cells, n_faces: int) -> Overlaps:
    """Return the overlaps of all cells of two meshes, in the order of the first one's cells."""
    found = []
    boxes = [Boxes.of(cells.polygons) for cells in (first, second)]
    for one, two in _candidates(first, second, n_faces):
        low = np.maximum(boxes[0].low[one], boxes[1].low[two])
        high = np.minimum(boxes[0].high[one], boxes[1].high[two])
        least = NOTHING * np.minimum(boxes[0].area[one], boxes[1].area[two])
        size = np.clip(high - low, 0, None).prod(axis=1)
        meet = size > least
        straight = boxes[0].full[one] & boxes[1].full[two]
        some = np.flatnonzero(meet & straight)
        found.append((one[some], two[some], _rectangles(low[some], high[some])))
        some = np.flatnonzero(meet & ~straight)
        common = intersections(first.polygons[one[some]], second.polygons[two[some]])
        kept = areas(common) > least[some]
        found.append((one[some][kept], two[some][kept], common[kept]))
    one, two = (np.concatenate([parts[k] for parts in found]) for k in (0, 1))
    order = np.lexsort((two, one))
    widest = max(parts[2].shape[1] for parts in found)
    common = np.concatenate([np.pad(parts[2], ((0, 0), (0, widest - parts[2].shape[1]), (0, 0)), "edge") for parts in found])
    return Overlaps(one[order], two[order], common[order])


@dataclass(frozen=True, eq=False)
class Boxes:
    """The boxes about polygons, (n, 2) metres each, areas of the polygons, (n,), and whether these fill their boxes."""

    low: np.ndarray
    high: np.ndarray
    area: np.ndarray
    full: np.ndarray

    @staticmethod
    def of(polygons: np.ndarray) -> "Boxes":
        """Return those of polygons."""
        low, high, area = polygons.min(axis=1), polygons.max(axis=1), areas(polygons)
        return Boxes(low, high, area, area > (1 - NOTHING) * (high - low).prod(axis=1))


def _rectangles(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return rectangles as polygons, (m, 4, 2)."""
    (left, below), (right, above) = low.T, high.T
    return np.stack([np.stack([left, right, right, left], axis=1), np.stack([below, below, above, above], axis=1)], axis=2)


def _candidates(first: Cells, second: Cells, n_faces: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield pairs of cells whose boxes overlap, each pair once.

    Faces have grids of about as many squares as cells. Cells are listed in each square that their boxes touch, and a pair counts
    in the lowest square that both touch.
    """
    low, high = np.full((n_faces, 2), np.inf), np.full((n_faces, 2), -np.inf)
    for cells in (first, second):
        np.minimum.at(low, cells.face, cells.polygons.min(axis=1))
        np.maximum.at(high, cells.face, cells.polygons.max(axis=1))
    counts = [np.bincount(cells.face, minlength=n_faces) for cells in (first, second)]
    squares = np.ceil(np.sqrt(np.sqrt(counts[0].astype(float) * counts[1]))).astype(np.int64)  # along each edge
    begin = np.cumsum(squares**2) - squares**2
    ends = [_squares(cells, low, high, squares) for cells in (first, second)]
    square, cell = _listed(ends[1], second.face, squares, begin, slice(0, len(second.face)))
    order = np.argsort(square, kind="stable")
    square, cell = square[order], cell[order]
    for part in pieces(len(first.face)):
        here, one = _listed(ends[0], first.face, squares, begin, part)
        start, stop = np.searchsorted(square, here), np.searchsorted(square, here, side="right")
        row, place = _ranges(start, stop - start)
        one, two, here = one[row], cell[place], here[row]
        lowest = np.maximum(ends[0][0][one], ends[1][0][two])
        face = first.face[one]
        some = begin[face] + lowest[:, 1] * squares[face] + lowest[:, 0] == here
        yield one[some], two[some]


def _squares(cells: Cells, low: np.ndarray, high: np.ndarray, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and highest square that the box of each cell touches, (n, 2) int64 each."""
    corner, size = low[cells.face], (high - low)[cells.face]
    most = squares[cells.face][:, None]
    scaled = [(end - corner) / size * most for end in (cells.polygons.min(axis=1), cells.polygons.max(axis=1))]
    return tuple(np.clip(np.floor(place).astype(np.int64), 0, most - 1) for place in scaled)  # type: ignore[return-value]


def _listed(ends, face: np.ndarray, squares: np.ndarray, begin: np.ndarray, part: slice) -> tuple[np.ndarray, np.ndarray]:
    """Return squares and cells, (k,) each: every square that each cell of a part touches."""
    low, high = (end[part] for end in ends)
    wide, deep = (high - low + 1).T
    cell, step = _ranges(np.zeros(len(wide), np.int64), wide * deep)
    at = face[part][cell]
    column, row = low[cell, 0] + step % wide[cell], low[cell, 1] + step // wide[cell]
    return begin[at] + row * squares[at] + column, cell + part.start


def _ranges(first: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return owners and numbers of ranges one after another: ``count`` numbers from each ``first`` on."""
    owner = np.repeat(np.arange(len(count)), count)
    return owner, first[owner] + np.arange(len(owner)) - (np.cumsum(count) - count)[owner]
