"""Indices of the Halton sequence whose lines have like directions.

Indices with equal remainder modulo S = 2^a 3^b have their first two numbers, a line's direction, in one box of 2^-a x 3^-b. A
patch that fires many lines for each box can fire them box by box. This gives packets of 16 like lines and needs no sorting. The
boxes are taken forward and backward in turn, so that consecutive boxes are neighbours in the square.

The first number times 2 pi is the angle about the normal. The second is the square of the sine of the angle to the normal. Where
that angle is 45 degrees, a step of the first moves the direction 4.4 times as far as one of the second. So there are more
columns than rows.
"""

import numpy as np

FULL = 30  # lines for each box: two packets, so that most of them hold lines of one box (measured)
SIZES = ((6, 3), (7, 3), (8, 3), (8, 4))  # (a, b): 1728, 3456, 6912, 20736 boxes; coarser ones do not pay (make bench)


def boxes(a: int, b: int) -> int:
    """Return the number of boxes, S."""
    return 2**a * 3**b


def lines(a: int, b: int) -> int:
    """Return how many lines of a patch fill the boxes."""
    return boxes(a, b) * FULL


def walk(a: int, b: int) -> np.ndarray:
    """Return remainders modulo S in the order in which lines take their boxes, (S,) uint32."""
    columns, rows = 2**a, 3**b
    row = np.repeat(np.arange(rows), columns)
    column = np.tile(np.arange(columns), rows)
    column = np.where(row % 2, columns - 1 - column, column)
    low, high = _mirrored(column, 2, a), _mirrored(row, 3, b)
    # the remainder modulo S that equals low modulo 2^a and high modulo 3^b
    inverse = pow(columns, -1, rows) if rows > 1 else 0
    return (low + columns * (((high - low) * inverse) % rows)).astype(np.uint32)


def _mirrored(value: np.ndarray, base: int, digits: int) -> np.ndarray:
    result = np.zeros_like(value)
    for _ in range(digits):
        result, value = result * base + value % base, value // base
    return result
