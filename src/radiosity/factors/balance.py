"""Balance: form factors are changed so that A_i F_ij = A_j F_ji, and rows sum to what did not escape.

First both estimates of a pair become one, (w_i A_i F_ij + w_j A_j F_ji) / (w_i + w_j). The weight of a row is the number of its
lines divided by its area. By Poisson statistics that is the best one, and the pair then counts each line at both its ends.
Then the symmetric matrix is scaled from both sides, d_i d_j, to the row sums (R. Sinkhorn and P. Knopp, "Concerning nonnegative
matrices and doubly stochastic matrices", Pacific J. Mathematics 21, 1967). Pairs that are zero stay zero.
"""

from collections.abc import Callable

import numpy as np

from .counts import WORD, split
from .model import Factors

BALANCED = 1e-6  # of the scene's area: scaling ends when the errors of all row sums together are below this
SCALINGS = 100  # at most: single rows may never reach their sum


def restored(factors: Factors, area: np.ndarray, weight: np.ndarray | None = None, scalings: int = SCALINGS) -> Factors:
    """Return reciprocal form factors whose rows sum to 1 - escaped - lost.

    What is left after the scalings is taken out of the rows alone. So sums are exact, and the A_i F_ij - A_j F_ji together
    come to some 1e-6 of the scene's area.

    Args:
        area: (n,) m².
        weight: (n,) weight of each row, any unit, not negative; by default 1 / area, which is equally many lines a row.
        scalings: largest number of scalings.
    """
    weight = 1 / area if weight is None else weight
    power = weight[factors.rows] * area[factors.rows] * factors.values
    one, other = factors.rows.astype(np.uint64), factors.columns.astype(np.uint64)
    keys, values = np.concatenate([one << WORD | other, other << WORD | one]), np.concatenate([power, power])
    order = np.argsort(keys, kind="stable")
    keys, values = keys[order], values[order]
    first = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]])) if len(keys) else np.zeros(0, np.int64)
    sums = np.add.reduceat(values, first) if len(keys) else np.zeros(0)
    rows, columns = split(keys[first])
    trust = weight[rows] + weight[columns]
    exchange = np.divide(sums, trust, out=np.zeros(len(sums)), where=trust > 0)
    wanted = area * np.maximum(1 - factors.escaped - factors.lost, 0)  # a share of all of it may be one and some rounding

    def row_sums(values: np.ndarray) -> np.ndarray:
        return np.bincount(rows, weights=values, minlength=len(area))

    scale = scaling(lambda d: d * row_sums(exchange * d[columns]), wanted, scalings)
    values = exchange * scale[rows] * scale[columns]
    return Factors(rows, columns, values * _ratio(wanted, row_sums(values))[rows] / area[rows], factors.escaped, factors.lost)


def restored_matrix(matrix: np.ndarray, area: np.ndarray, missed: np.ndarray, weight: np.ndarray | None = None) -> np.ndarray:
    """Return a full matrix, (n, n), balanced as by `restored`.

    Args:
        missed: (n,) share of what leaves a patch that reaches no other: escaped and lost.
    """
    weight = 1 / area if weight is None else weight
    power = matrix * (weight * area)[:, None]
    trust = weight[:, None] + weight
    exchange = np.divide(power + power.T, trust, out=np.zeros_like(power), where=trust > 0)
    wanted = area * np.maximum(1 - missed, 0)
    scale = scaling(lambda d: d * (exchange @ d), wanted, SCALINGS)
    values = exchange * scale * scale[:, None]
    return values * (_ratio(wanted, values.sum(axis=1)) / area)[:, None]


def scaling(row_sums: Callable[[np.ndarray], np.ndarray], wanted: np.ndarray, scalings: int) -> np.ndarray:
    """Return d, (n,), such that rows of d_i X_ij d_j, summed by ``row_sums``, come to what is wanted."""
    scale = np.ones(len(wanted))
    for _ in range(scalings):
        sums = row_sums(scale)
        if np.abs(wanted - sums).sum() < BALANCED * wanted.sum():
            break
        scale *= np.sqrt(_ratio(wanted, sums))
    return scale


def _ratio(wanted: np.ndarray, sums: np.ndarray) -> np.ndarray:
    return np.divide(wanted, sums, out=np.ones(len(sums)), where=sums > 0)
