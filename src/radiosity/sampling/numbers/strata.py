"""Indices of the Halton sequence whose lines have like directions.

Indices with equal remainder modulo S = 2^a 3^b have their first two numbers, a line's direction, in one box of 2^-a x 3^-b. A
patch that fires many lines for each box can fire them box by box. This gives packets of 16 like lines and needs no sorting. The
boxes are taken forward and backward in turn, so that consecutive boxes are neighbours in the square.

A round is 16 S consecutive indices: 16 of each box. A packet that holds lines of two boxes, or of two patches, takes as long as
one of lines that are not alike. So lines are traced in packets in whole rounds alone (`tracing.rounds`).

The first number times 2 pi is the angle about the normal. The second is the square of the sine of the angle to the normal. Where
that angle is 45 degrees, a step of the first moves the direction 4.4 times as far as one of the second. So there are more
columns than rows.
"""

from functools import cache

import numpy as np

PACKET = 16  # lines that are traced together where vectors are widest; half as many still divide it
SIZES = ((4, 2), (5, 2), (5, 3), (6, 3), (7, 3), (8, 3), (8, 4))  # (a, b): 144, 288, 864, 1728, 3456, 6912, 20736 boxes


def boxes(a: int, b: int) -> int:
    """Return the number of boxes, S."""
    return 2**a * 3**b


def lines(a: int, b: int) -> int:
    """Return the number of lines of a round."""
    return boxes(a, b) * PACKET


@cache
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
