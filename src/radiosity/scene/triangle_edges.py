"""Edges of triangles: a number each, which is four times the row of the triangle plus the corner at which the edge begins."""

from dataclasses import dataclass

import numpy as np

from .measures import length, minus

ENDS = (1, 2, 0)  # the corner where the edge ends that begins at each corner
ACROSS = (2, 0, 1)  # the corner that is not on it

Pairs = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles of surfaces.

    Attributes:
        corners: (n, 3) int64, vertices.
        place: (n_vertices,) int64, equal for vertices at the same place; None: no two are.
        surface: (n,) int32.
        axes: three of (n_vertices,) metres, the coordinates of the vertices along each axis.
        tolerance: of parallelograms, of their longest edge.
    """

    corners: np.ndarray
    place: np.ndarray | None
    surface: np.ndarray
    axes: list[np.ndarray]
    tolerance: float

    def ends(self, edge: np.ndarray) -> Pairs:
        """Return the vertices where edges begin and end."""
        row, corner = edge >> 2, edge & 3
        return self._at(row, corner), self._at(row, np.take(ENDS, corner))

    def across(self, edge: np.ndarray) -> np.ndarray:
        """Return the vertices across from edges."""
        return self._at(edge >> 2, np.take(ACROSS, edge & 3))

    def of(self, part: slice) -> np.ndarray:
        """Return the places of some triangles' corners, (3, m) int64."""
        corners = np.ascontiguousarray(self.corners[part].T)
        return corners if self.place is None else self.place.take(corners)

    def _at(self, row: np.ndarray, corner: np.ndarray) -> np.ndarray:
        vertex = self.corners[row, corner]
        return vertex if self.place is None else self.place.take(vertex)

    def opposite(self, one: np.ndarray, two: np.ndarray) -> Pairs:
        """Return those pairs whose edges are run through in opposite directions, by triangles of one surface."""
        (start, end), (begin, stop) = self.ends(one), self.ends(two)
        same = (start == stop) & (end == begin) & (start != end) & (self.surface[one >> 2] == self.surface[two >> 2])
        return one[same], two[same]

    def parallelograms(self, one: np.ndarray, two: np.ndarray) -> Pairs:
        """Return those pairs whose triangles are the halves of a parallelogram, or nearly so."""
        a, b, c, d = ([axis[at] for axis in self.axes] for at in (*self.ends(one), self.across(one), self.across(two)))
        longest = np.maximum(
            np.maximum(length(minus(a, c)), length(minus(b, c))), np.maximum(length(minus(a, d)), length(minus(b, d)))
        )
        near = length(minus(minus(a, c), minus(d, b))) <= 2 * self.tolerance * longest
        return one[near], two[near]

    def compared(self, edge: np.ndarray) -> Pairs:
        """Return the pairs among some edges, all of which are given that have the same ends; they are compared one by one."""
        start, end = self.ends(edge)
        columns = np.minimum(start, end), np.maximum(start, end), self.surface[edge >> 2]
        order = np.lexsort(columns)
        same = np.all([column[order][1:] == column[order][:-1] for column in columns], axis=0)
        first = np.flatnonzero(alone(np.concatenate([[False], same, [False]])))
        return self.opposite(edge[order[first]], edge[order[first + 1]])


def edges_of(rows: np.ndarray) -> np.ndarray:
    """Return the edges of triangles, (3 m,) int64."""
    return (4 * rows[:, None] + np.arange(3)).ravel()


def alone(follows: np.ndarray) -> np.ndarray:
    """Return which entries begin a run of two and no more, (n,) bool, of which follow the one before, (n + 1,); last, False."""
    result = follows[1:].copy()
    result &= ~follows[:-1]
    result[:-1] &= ~follows[2:]
    return result


def in_larger_runs(follows: np.ndarray) -> np.ndarray:
    """Return which entries are in runs of three and more, (n,) bool, of which follow the one before, (n + 1,); last, False."""
    middle = follows[:-1] & follows[1:]
    result = middle.copy()
    result[1:] |= middle[:-1]
    result[:-1] |= middle[1:]
    return result
