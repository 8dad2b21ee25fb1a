"""From counted lines to form factors, and from form factors to irradiance."""

import math

import numpy as np

from .balance import restored
from .counts import split
from .factors import Factors

TOLERANCE = 1e-10  # relative, of radiosity
SCALINGS = 20  # at most: few rows are far off then, and counts are not worth more


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
    """A_i F_ij = A_j F_ji = (n_ij + n_ji) / (n_i / A_i + n_j / A_j), then scaled until rows sum to what did not escape: every
    line is used at both its ends, see `balance.restored`."""
    rows, _ = split(keys)
    return restored(of_rows(keys, counts, n), area, np.bincount(rows, weights=counts, minlength=n) / area, SCALINGS)


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
