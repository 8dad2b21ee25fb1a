"""Cells of a face by arithmetic: (u, v) to cell number and back, without storing a mesh.

A parallelogram is cut into columns x rows cells, numbered row by row. A triangle with k cells along an edge is cut
into k² congruent triangles: row r holds 2 (k - r) - 1 of them, upright and inverted in turn, so that row r begins at
cell k² - (k - r)². The place of a cell is its column, its row, and whether it is inverted.
"""

import numpy as np

MOST = 16383  # columns or rows: they are packed into 14 bits


def count(columns: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return the number of cells of faces."""
    return columns.astype(np.int64) * rows.astype(np.int64)  # for a triangle columns == rows == k


def place(cell: np.ndarray, columns: np.ndarray, is_quad: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return column, row and inverted flag of cells from their numbers."""
    columns = columns.astype(np.int64)
    k = columns
    rest = np.maximum(k * k - cell, 0)
    root = np.ceil(np.sqrt(rest.astype(np.float64))).astype(np.int64)
    root += root * root < rest
    root -= (root - 1) * (root - 1) >= rest
    row_triangle = k - root
    along = cell - (k * k - root * root)
    row = np.where(is_quad, cell // np.maximum(columns, 1), row_triangle)
    column = np.where(is_quad, cell % np.maximum(columns, 1), along // 2)
    inverted = np.where(is_quad, False, along % 2 == 1)
    return column, row, inverted


def number(u: np.ndarray, v: np.ndarray, columns: np.ndarray, rows: np.ndarray, is_quad: np.ndarray) -> np.ndarray:
    """Return the number of the cell that holds face coordinates (u, v); points on or over the rim belong to the nearest cell."""
    columns, rows = columns.astype(np.int64), rows.astype(np.int64)
    x, y = u * columns, v * rows
    row = np.clip(np.floor(y).astype(np.int64), 0, rows - 1)
    limit = np.where(is_quad, columns, columns - row)
    column = np.clip(np.floor(x).astype(np.int64), 0, limit - 1)
    inverted = (x - column) + (y - row) > 1
    inverted &= column < limit - 1
    return at(column, row, inverted, columns, is_quad)


def at(column, row, inverted, columns, is_quad) -> np.ndarray:
    """Return the number of the cell at a place: the inverse of `place`."""
    return np.where(is_quad, row * columns + column, row * (2 * columns - row) + 2 * column + inverted)


def corners(column, row, inverted, columns, rows, is_quad) -> np.ndarray:
    """Return face coordinates of the cells' corners, (m, 4, 2), counterclockwise; a triangle repeats its third."""
    x = np.asarray(column)[:, None] + np.where(
        is_quad[:, None], [0, 1, 1, 0], np.where(np.asarray(inverted)[:, None], [1, 0, 1, 1], [0, 1, 0, 0])
    )
    y = np.asarray(row)[:, None] + np.where(
        is_quad[:, None], [0, 0, 1, 1], np.where(np.asarray(inverted)[:, None], [1, 1, 0, 0], [0, 0, 1, 1])
    )
    return np.stack([x / columns[:, None], y / rows[:, None]], axis=2)
