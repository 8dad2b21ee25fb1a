"""From counted lines to form factors, and from form factors to irradiance."""

import math
from dataclasses import dataclass

import numpy as np

from .counts import WORD, split

TOLERANCE = 1e-10  # relative, of radiosity
BALANCED = 1e-6  # of the scene's area: how far off row sums may be together while they are scaled
SCALINGS = 20  # at most: few rows are far off then, and single ones may never meet their sum


@dataclass(frozen=True, eq=False)
class Factors:
    """Sparse form factors of one replicate.

    Attributes:
        rows, columns: (m,) int64, patches.
        values: (m,) float64, F_ij: share of what leaves patch ``rows`` that arrives at patch ``columns``.
        escaped, lost: (n,) float64, share of what leaves a patch that leaves the scene, or lands on absorbing backs.
    """

    rows: np.ndarray
    columns: np.ndarray
    values: np.ndarray
    escaped: np.ndarray
    lost: np.ndarray

    def sent(self, area: np.ndarray) -> "Factors":
        """As `gather` has to have them where light goes by the lines' own directions: A_i F_ij / A_j in place of F_ji. Backs that
        let lines pass make the two different."""
        values = self.values * area[self.rows] / area[self.columns]
        return Factors(self.columns, self.rows, values, self.escaped, self.lost)

    def gather(self, radiosity: np.ndarray) -> np.ndarray:
        """(n,) irradiance, sum_j F_ij B_j."""
        return np.bincount(self.rows, weights=self.values * radiosity[self.columns], minlength=len(radiosity))


def of_rows(keys: np.ndarray, counts: np.ndarray, n: int) -> Factors:
    """F_ij = n_ij / n_i: every row is what its own lines saw, and sums to 1 with what escaped (Sbert 1993).

    Args:
        keys, counts: of one replicate, rows from 0; columns n and n + 1 are lines escaped and lost.
    """
    rows, columns = split(keys)
    fired = np.maximum(np.bincount(rows, weights=counts, minlength=n), 1)
    shares = counts / fired[rows]
    escaped, lost = (np.bincount(rows[columns == code], weights=shares[columns == code], minlength=n) for code in (n, n + 1))
    inside = columns < n
    return Factors(rows[inside], columns[inside], shares[inside], escaped, lost)


def of_both_ways(keys: np.ndarray, counts: np.ndarray, n: int, area: np.ndarray) -> Factors:
    """A_i F_ij = A_j F_ji = (n_ij + n_ji) / (n_i / A_i + n_j / A_j), then scaled from both sides, d_i d_j, until rows sum to what
    did not escape: every line is used at both its ends (R. Sinkhorn and P. Knopp, Pacific J. Mathematics 21, 1967)."""
    one_way = of_rows(keys, counts, n)
    rows, columns = split(keys)
    density = np.bincount(rows, weights=counts, minlength=n) / area
    inside = columns < n
    back = (columns[inside].astype(np.uint64) << WORD) | rows[inside].astype(np.uint64)
    both = np.concatenate([keys[inside], back])
    order = np.argsort(both, kind="stable")
    both, sums = both[order], np.concatenate([counts[inside], counts[inside]])[order]
    first = np.flatnonzero(np.concatenate([[True], both[1:] != both[:-1]])) if len(both) else np.zeros(0, np.int64)
    sums = np.add.reduceat(sums, first, dtype=np.float64) if len(both) else np.zeros(0)
    rows, columns = split(both[first])
    exchange = sums / (density[rows] + density[columns])
    wanted = area * (1 - one_way.escaped - one_way.lost)
    values = _balanced(rows, columns, exchange, wanted)
    return Factors(rows, columns, values / area[rows], one_way.escaped, one_way.lost)


def _balanced(rows: np.ndarray, columns: np.ndarray, exchange: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """A symmetric matrix scaled from both sides to row sums; the last rest is taken out of the rows alone."""
    n, scale = len(wanted), np.ones(len(wanted))
    for _ in range(SCALINGS):
        sums = scale * np.bincount(rows, weights=exchange * scale[columns], minlength=n)
        ratio = np.divide(wanted, sums, out=np.ones(n), where=sums > 0)
        if np.abs(wanted - sums).sum() < BALANCED * wanted.sum():
            break
        scale *= np.sqrt(ratio)
    values = exchange * scale[rows] * scale[columns]
    sums = np.bincount(rows, weights=values, minlength=n)
    return values * np.divide(wanted, sums, out=np.ones(n), where=sums > 0)[rows]


def irradiance(factors: Factors, emission: np.ndarray, reflectance: np.ndarray) -> np.ndarray:
    """(n,) H = F B where B = E + rho H, by Jacobi iterations, each at most rho_max of the last change."""
    received = np.zeros(len(emission))
    bound = float(reflectance.max(initial=0.0))
    steps = 2 + (math.ceil(math.log(TOLERANCE * (1 - bound)) / math.log(bound)) if bound > 0 else 0)
    for _ in range(steps):
        new = factors.gather(emission + reflectance * received)
        change, received = np.abs(new - received).max(), new
        if change * bound <= TOLERANCE * (1 - bound) * received.max(initial=0.0):
            break
    return received
