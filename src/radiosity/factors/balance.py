"""Balance: form factors are changed so that A_i F_ij = A_j F_ji, and rows sum to what did not escape.

First both estimates of a pair become one, (w_i A_i F_ij + w_j A_j F_ji) / (w_i + w_j). The weight of a row is the number of its
lines divided by its area. By Poisson statistics that is the best one, and the pair then counts each line at both its ends.
Then the symmetric matrix is scaled from both sides, d_i d_j, to the row sums (R. Sinkhorn and P. Knopp, "Concerning nonnegative
matrices and doubly stochastic matrices", Pacific J. Mathematics 21, 1967). Pairs that are zero stay zero.

Where what escapes was counted, too, it is as uncertain as the rest of its row, and scaled with it. Otherwise a large patch whose
few lines towards a small one all missed it would take away what the lines of the small one found.
"""

from collections.abc import Callable

import numpy as np

from .counts import WORD, split
from .model import Factors

BALANCED = 1e-6  # of the scene's area: scaling ends when the errors of all row sums together are below this
SCALINGS = 100  # at most: single rows may never reach their sum


def restored(
    factors: Factors, area: np.ndarray, weight: np.ndarray | None = None, scalings: int = SCALINGS, *, counted: bool = False
) -> Factors:
    """Return reciprocal form factors whose rows, with what escapes and is lost, sum to one.

    What is left after the scalings is taken out of the rows alone. So sums are exact, and the A_i F_ij - A_j F_ji together
    come to some 1e-6 of the scene's area.

    Args:
        area: (n,) m².
        weight: (n,) weight of each row, any unit, not negative; by default 1 / area, which is equally many lines a row.
        scalings: largest number of scalings.
        counted: what escapes and is lost was counted as the factors were, and is scaled with its row. Otherwise it stays.
    """
    weight = 1 / area if weight is None else weight
    rows, columns, exchange = _of_pairs(factors, area, weight)
    escaped, lost = factors.escaped, factors.lost
    del factors  # the entries may be let go
    missed = area * (escaped + lost) if counted else np.zeros(len(area))
    wanted = area if counted else area * np.maximum(1 - escaped - lost, 0)  # all of it may be one and some rounding

    def row_sums(other: np.ndarray | None = None) -> np.ndarray:
        if other is None:
            return np.bincount(rows, weights=exchange, minlength=len(area))
        values = other[columns]
        values *= exchange
        return np.bincount(rows, weights=values, minlength=len(area))

    scale = scaling(lambda d: d * (row_sums(d) + missed), wanted, scalings)
    exchange *= scale[rows]
    exchange *= scale[columns]
    share = _ratio(wanted, row_sums() + scale * missed)
    exchange *= share[rows]
    exchange /= area[rows]
    if counted:
        escaped, lost = escaped * scale * share, lost * scale * share
    return Factors(rows, columns, exchange, escaped, lost)


def _of_pairs(factors: Factors, area: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return rows, columns and weighted means of A_i F_ij and A_j F_ji, (k,) each: both directions of each pair, in order."""
    m = len(factors.rows)
    keys = np.empty(2 * m, np.uint64)
    for here, one, other in ((keys[:m], factors.rows, factors.columns), (keys[m:], factors.columns, factors.rows)):
        here[:] = one
        here <<= WORD
        here |= other.astype(np.uint64)
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    order[order >= m] -= m
    power = weight[factors.rows]
    power *= area[factors.rows]
    power *= factors.values
    del factors
    values = power[order]
    del order, power
    changes = np.ones(2 * m, bool)
    np.not_equal(keys[1:], keys[:-1], out=changes[1:])
    first = np.flatnonzero(changes)
    del changes
    values = np.add.reduceat(values, first) if m else np.zeros(0)
    keys = keys[first]
    del first
    rows, columns = split(keys)
    del keys
    trust = weight[rows]
    trust += weight[columns]
    values[trust <= 0] = 0
    np.divide(values, trust, out=values, where=trust > 0)
    return rows, columns, values


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
