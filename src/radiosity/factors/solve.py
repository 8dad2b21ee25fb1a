"""Functions that turn counted lines into form factors, and form factors into irradiance."""

import math

import numpy as np

from ..patches.scatter import Scatter
from .balance import restored
from .counts import split
from .model import Factors

TOLERANCE = 1e-10  # relative, of radiosity
SCALINGS = 20  # at most: few rows are far off then, and counts are not exact enough for more


def of_rows(keys: np.ndarray, counts: np.ndarray, n: int) -> Factors:
    """Return F_ij = n_ij / n_i: every row comes from its own lines, and sums to 1 with what escaped (Sbert 1993).

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
    """Return A_i F_ij = A_j F_ji = (n_ij + n_ji) / (n_i / A_i + n_j / A_j), scaled until rows sum to one with what escapes.

    Every line is used at both its ends, see `balance.restored`.
    """
    rows, _ = split(keys)
    return restored(of_rows(keys, counts, n), area, np.bincount(rows, weights=counts, minlength=n) / area, SCALINGS, counted=True)


def irradiance(factors: Factors, emission: np.ndarray, scatter: Scatter, filled=lambda received: received) -> np.ndarray:
    """Return H = F B, (n,), where B = E + rho H, by Jacobi iterations; each change is at most rho_max times the last one.

    Args:
        scatter: what patches send on, of one band.
        filled: takes irradiance, (n,), and returns it with values for patches whose rows are empty.
    """
    received = np.zeros(len(emission))
    bound = float(scatter.albedo.max(initial=0.0))
    steps = 2 + (math.ceil(math.log(TOLERANCE * (1 - bound)) / math.log(bound)) if bound > 0 else 0)
    for _ in range(steps):
        new = filled(factors.gather(emission + scatter.of(received)))
        change, received = np.abs(new - received).max(), new
        if change * bound <= TOLERANCE * (1 - bound) * received.max(initial=0.0):
            break
    return received


def of_own_light(factors: Factors, area, lines, emission, scatter: Scatter, received, *, both_ways: bool) -> np.ndarray:
    """Return the bias of irradiance, (n,), to the first order in the reciprocal of the number of lines.

    Lines between i and j count in both rows. So where by chance many lines lead from a patch to j, as many bring its light back.
    With Var(n_ij) = n_i F_ij, and rows that sum to 1, E[F_ij F_jk] - F_ij F_jk is F_ij / n_j for k = i, less F_ij F_jk / n_j. So
    i receives sum_j F_ij rho_j (B_i - H_j) / n_j too much, and all patches receive what is reflected of that. Where local lines
    count both ways, A_j (n_i / A_i + n_j / A_j) takes the place of n_j.

    Args:
        area, lines, emission, received: (n,); ``lines`` of each row.
        scatter: what patches send on, of one band. What crosses a pane goes on along lines of another row, without this bias.
    """
    i, j = factors.rows, factors.columns
    known = known_lines(factors, area, lines, both_ways=both_ways)
    more = (emission + scatter.of(received))[i] - received[j]
    own = np.bincount(i, weights=factors.values * scatter.reflectance[j] * more / known, minlength=len(lines))
    # in two parts, since `irradiance` solves for values that are not negative
    up, down = (np.maximum(sign * own, 0) for sign in (1, -1))
    reflected = [irradiance(factors, scatter.of(part), scatter) for part in (up, down)]
    return np.abs(own + reflected[0] - reflected[1])


def known_lines(factors: Factors, area: np.ndarray, lines: np.ndarray, *, both_ways: bool) -> np.ndarray:
    """Return how many lines each factor is known by, (m,), as of `of_own_light`."""
    i, j, one = factors.rows, factors.columns, np.maximum(lines, 1)
    return one[j] + (one[i] * area[j] / area[i] if both_ways else 0)
