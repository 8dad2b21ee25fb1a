"""Elements: a quadtree on each radiating side of a face. They are found by arithmetic from (face, side, u, v), and not stored.

A face of C columns and R rows, both powers of two, has the levels 0 to log2 max(C, R). Level l cuts it into min(2^l, C) x
min(2^l, R) congruent cells, numbered as in `cells`: level 0 is the face itself, the deepest level its patches. An element has
four children, or two where one direction is not cut any more. Elements are numbered by side (in the order of the patches: face,
front, radiating back), level, cell.

With a = log2 min(C, R), the levels above l hold (4^min(l, a) - 1) / 3 + 2^a (2^max(l, a) - 2^a) cells of a side.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import SceneError
from . import cells
from .model import Patches

# columns, rows and inverted flags of the four children within a parallelogram, an upright and an inverted triangle
CHILDREN = np.array(
    [
        [[0, 1, 0, 1], [0, 0, 1, 1], [0, 0, 0, 0]],
        [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
        [[1, 1, 0, 1], [1, 0, 1, 1], [1, 1, 1, 0]],
    ]
)

Place = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class Hierarchy:
    """A hierarchy of elements whose leaves are patches. All arrays of element numbers are (m,) int64, in any order.

    Attributes:
        patches: the leaves; columns and rows are powers of two (``subdivide(..., powers_of_two=True)``).

    Raises:
        SceneError: columns or rows are not powers of two.
    """

    patches: Patches

    def __post_init__(self):
        columns, rows = self.patches.columns, self.patches.rows
        wrong = np.flatnonzero((columns & (columns - 1)) | (rows & (rows - 1)))
        if len(wrong):
            scene, face = self.patches.scene, int(wrong[0])
            raise SceneError(
                f"{scene.source}: face {face} of surface '{scene.names[scene.surface[face]]}' has {columns[face]} x {rows[face]} "
                "cells; a hierarchy needs powers of two: cut the scene by subdivide(..., powers_of_two=True)"
            )

    def __len__(self) -> int:
        return int(self.first[-1])

    @cached_property
    def side_face(self) -> np.ndarray:
        """The face of each radiating side, (n_sides,) int64."""
        return np.repeat(np.arange(self.patches.scene.n_faces), np.diff(self.patches.first) // self.patches.cells_per_face)

    @cached_property
    def side_is_back(self) -> np.ndarray:
        """Which radiating sides are backs, (n_sides,) bool."""
        return np.concatenate([[False], self.side_face[1:] == self.side_face[:-1]])

    @cached_property
    def side_patch(self) -> np.ndarray:
        """The first patch of each side, (n_sides,) int64."""
        return self.patches.first[self.side_face] + np.where(self.side_is_back, self.patches.cells_per_face[self.side_face], 0)

    @cached_property
    def _shape(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Columns and rows of each side's patches, and the level up to which both are cut, (n_sides,) int64 each."""
        columns, rows = (count.astype(np.int64)[self.side_face] for count in (self.patches.columns, self.patches.rows))
        return columns, rows, exponent(np.minimum(columns, rows))

    @cached_property
    def deepest(self) -> np.ndarray:
        """The level of each side's patches, (n_sides,) int64."""
        return exponent(np.maximum(*self._shape[:2]))

    @cached_property
    def first(self) -> np.ndarray:
        """The root of each side, and in the end the number of elements, (n_sides + 1,) int64."""
        return np.concatenate([[0], np.cumsum(self._above(np.arange(len(self.side_face)), self.deepest + 1))])

    def _above(self, side: np.ndarray, level: np.ndarray) -> np.ndarray:
        """Return the number of cells of the levels above a level."""
        both = self._shape[2][side]
        return ((1 << 2 * np.minimum(level, both)) - 1) // 3 + ((1 << both) * ((1 << np.maximum(level, both)) - (1 << both)))

    def side(self, element: np.ndarray) -> np.ndarray:
        """Return the radiating side of elements."""
        return np.searchsorted(self.first, element, side="right") - 1

    def face(self, element: np.ndarray) -> np.ndarray:
        """Return the face of elements."""
        return self.side_face[self.side(element)]

    def level(self, element: np.ndarray) -> np.ndarray:
        """Return the level of elements; a whole side has level 0."""
        side = self.side(element)
        number, both = element - self.first[side], self._shape[2][side]
        square = ((1 << 2 * both) - 1) // 3  # cells of the levels whose cells are cut in both directions
        long = exponent(((number - square) >> both) + (1 << both))
        return np.where(number < square, exponent(3 * number + 1) // 2, long)

    def place(self, element: np.ndarray) -> Place:
        """Return side, level, column, row and inverted flag of elements."""
        side, level = self.side(element), self.level(element)
        columns, _ = self.grid(side, level)
        cell = element - self.first[side] - self._above(side, level)
        return side, level, *cells.place(cell, columns, self._is_quad(side))

    def at(self, side: np.ndarray, level: np.ndarray, column: np.ndarray, row: np.ndarray, inverted: np.ndarray) -> np.ndarray:
        """Return the element at a place: the inverse of `place`."""
        cell = cells.at(column, row, inverted, self.grid(side, level)[0], self._is_quad(side))
        return self.first[side] + self._above(side, level) + cell

    def find(self, side: np.ndarray, level: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return the element of a level (or of the deepest one, where that is above it) that holds face coordinates (u, v)."""
        level = np.minimum(level, self.deepest[side])
        cell = cells.number(u, v, *self.grid(side, level), self._is_quad(side))
        return self.first[side] + self._above(side, level) + cell

    def grid(self, side: np.ndarray, level: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return columns and rows of a level of sides, (m,) int64 each."""
        return tuple(np.minimum(1 << level, count[side]) for count in self._shape[:2])  # type: ignore[return-value]

    def _is_quad(self, side: np.ndarray) -> np.ndarray:
        return self.patches.scene.is_quad[self.side_face[side]]

    def is_leaf(self, element: np.ndarray) -> np.ndarray:
        """Return whether elements are patches."""
        return self.level(element) == self.deepest[self.side(element)]

    def patch(self, leaf: np.ndarray) -> np.ndarray:
        """Return the patches that leaves are."""
        side = self.side(leaf)
        return self.side_patch[side] + leaf - self.first[side] - self._above(side, self.deepest[side])

    def leaf(self, patch: np.ndarray) -> np.ndarray:
        """Return the elements that patches are: the inverse of `patch`."""
        side = np.searchsorted(self.side_patch, patch, side="right") - 1
        return self.first[side] + self._above(side, self.deepest[side]) + patch - self.side_patch[side]

    def parent(self, element: np.ndarray) -> np.ndarray:
        """Return the parent of each element; -1 for a whole side."""
        side, level, column, row, inverted = self.place(element)
        columns, rows, _ = self._shape
        above = np.maximum(level - 1, 0)
        # where a triangle's cell is cut into four, an inverted parent has all but the upright cell at its corner
        odd = (column & 1) + (row & 1) + inverted
        column = np.where(1 << above < columns[side], column >> 1, column)
        row = np.where(1 << above < rows[side], row >> 1, row)
        return np.where(level == 0, -1, self.at(side, above, column, row, ~self._is_quad(side) & (odd >= 2)))

    def children(self, element: np.ndarray) -> np.ndarray:
        """Return the children of elements, (m, 4) int64.

        Children that do not exist are -1: all of a leaf, and two of an element that is cut in one direction.
        """
        side, level, column, row, inverted = (x[:, None] for x in self.place(element))
        columns, rows, _ = self._shape
        quad, wide, high = self._is_quad(side), 1 << level < columns[side], 1 << level < rows[side]
        step_u, step_v, flag = np.moveaxis(CHILDREN[np.where(quad, 0, np.where(inverted, 2, 1))[:, 0]], 1, 0)
        exists = (wide | high) & (wide | (step_u == 0) | ~quad) & (high | (step_v == 0) | ~quad)
        column, row = np.where(wide, 2 * column + step_u, column), np.where(high, 2 * row + step_v, row)
        return np.where(exists, self.at(side, np.where(wide | high, level + 1, level), column, row, flag == 1), -1)


def exponent(number: np.ndarray) -> np.ndarray:
    """Return floor(log2) of whole numbers from 1 to 2^53, int64."""
    return np.frexp(number.astype(np.float64))[1].astype(np.int64) - 1
