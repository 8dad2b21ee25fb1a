"""All pairs of patches by polygons, each pair once."""

import numpy as np

from ..engine.matrix.factors import Factors
from .polygon_rows import PAIRS, PolygonRows
from .rows import Swept


def symmetric_pairs(rows: PolygonRows, n: int, replicate: int, swept: Swept) -> tuple[Factors, int]:
    """The whole matrix and the lines it took: A_i F_ij = A_j F_ji holds to the last bit of A_i F_ij."""
    ones, others, values, lines, first = [], [], [], 0, 0
    while first < n:
        last = first + 1
        while last < n and (2 * n - first - last) * (last + 1 - first) // 2 <= PAIRS:
            last += 1
        one = np.repeat(np.arange(first, last), n - 1 - np.arange(first, last))
        other = np.concatenate([np.arange(i + 1, n) for i in range(first, last)])
        one, other, value = rows.pairs(one, other, replicate, label=one)
        ones, others, values = [*ones, one.astype(np.int32)], [*others, other.astype(np.int32)], [*values, value]
        lines += len(one) * rows.samples
        swept(len(one) * rows.samples)
        first = last
    one, other, value = (np.concatenate(x) for x in (ones, others, values))
    shares = np.concatenate([value / rows.area[one], value / rows.area[other]])
    one, other = np.concatenate([one, other]), np.concatenate([other, one])
    missed = rows.missed.make(np.arange(n), replicate, swept)
    return Factors(one, other, shares, missed.escaped, missed.lost), lines + missed.lines
