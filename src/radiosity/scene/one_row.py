"""Values of faces that are all the same have one row in memory, however many faces there are."""

import numpy as np


def row_or_all(values: np.ndarray) -> np.ndarray:
    """Return the row, (1, ...), that all rows of an array are in memory, or else the array: for what is asked of every row."""
    return values[:1] if is_one_row(values) else values


def chosen(values: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return some rows (indices) of an array; of one row in memory there stays one."""
    if is_one_row(values):
        return np.broadcast_to(values[:1], (len(rows), *values.shape[1:]))
    return values.take(rows, axis=0)


def is_one_row(values: np.ndarray) -> bool:
    """Return whether all rows of an array are the same place in memory."""
    return values.ndim > 0 and len(values) > 1 and values.strides[0] == 0
