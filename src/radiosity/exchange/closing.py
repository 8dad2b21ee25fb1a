"""Exchange areas of polygons that close: the nearest ones to what was measured, weighted by its errors.

The problem is that of `least_squares`, in full matrices: each pair is there, both ways, and variances tell how far each may move.
Newton's steps are found by conjugate gradients, whose products are those of a matrix and a vector. So thousands of groups close
in about a second. From `SAMPLED` groups on the steps end where sums are right to 1e-7, and rows take up what is left: they close
as well, and the two directions of a pair agree to 1e-7 of the area.
"""

from dataclasses import dataclass

import numpy as np

from .restoration import SAMPLED

CLOSED, NEARLY = 1e-14, 1e-7  # of a group's area: steps end when no sum is further off; the second with many groups
STEPS, PRODUCTS = 12, 60  # Newton's, and those of conjugate gradients in each
ENOUGH = 1e-3  # of what a sum lacks, by which conjugate gradients end
REGULAR = 1e-13  # added to the scaled matrix: groups that see only each other have one multiplier too many
EXACTLY = 128  # groups: with more the variances that closure leaves are estimated from each pair's own rows
MOVED = 6  # standard errors that the sum of a row may lack, or something escapes that no line found


@dataclass(frozen=True, eq=False)
class Measured:
    """Exchange areas of groups that are to close.

    Attributes:
        values, variances: (n, n) m² and m⁴, symmetric. What a group sends to itself counts once.
        gone, gone_variances: (2, n) what escapes and what is lost.
        area: (n,) m².
    """

    values: np.ndarray
    variances: np.ndarray
    gone: np.ndarray
    gone_variances: np.ndarray
    area: np.ndarray

    @property
    def lacking(self) -> np.ndarray:
        """What sums of rows lack, (n,) m²."""
        return self.area - self.values.sum(axis=1) - self.gone.sum(axis=0)

    @property
    def slack(self) -> np.ndarray:
        """The variance of the sum of each row, (n,) m⁴."""
        return self.variances.sum(axis=1, dtype=np.float64) + self.gone_variances.sum(axis=0)


def opened(measured: Measured, one_line: np.ndarray) -> Measured:
    """Return the same, where rows that lack more than errors tell may send something out of the scene.

    Args:
        one_line: (n,) m², what a line stands for that looks for what escapes: it found nothing there.
    """
    lacks = measured.lacking > MOVED * np.sqrt(measured.slack)
    some = lacks & (measured.gone[0] == 0)
    if not some.any():
        return measured
    variances = measured.gone_variances.copy()
    variances[0, some] = np.maximum(variances[0, some], one_line[some] ** 2)
    return Measured(measured.values, measured.variances, measured.gone, variances, measured.area)


def closed(measured: Measured) -> tuple[Measured, bool]:
    """Return what closes, with the variances that are left, and whether it does. The arrays of ``measured`` are used up."""
    values, variances, area = measured.values, measured.variances, measured.area
    n, own = len(area), np.diag_indices(len(area))
    variances[own] /= 2  # so that the sum of both multipliers counts once
    kept = variances.copy()
    variances *= values > 0  # what is zero, or comes to it, stays zero, and keeps its variance
    enough = CLOSED if n <= SAMPLED else NEARLY
    gone, most, worst = measured.gone.copy(), measured.gone_variances, np.inf
    scale = np.where(area > 0, area, 1.0)
    for _ in range(STEPS):
        lacking = area - values.sum(axis=1) - gone.sum(axis=0)
        before, worst = worst, float(np.abs(lacking / scale).max(initial=0.0))
        if worst <= enough or (worst <= 1e-12 and worst >= before):
            break
        u = _multipliers(variances, most.sum(axis=0), lacking)
        for at in range(0, n, step := max((1 << 20) // n, 1)):
            rows = slice(at, at + step)
            moved = u[rows, None] + u
            moved *= variances[rows]
            values[rows] += moved
            if values[rows].min(initial=0.0) < 0:
                np.maximum(values[rows], 0, out=values[rows])
                variances[rows] *= values[rows] > 0
        gone = np.maximum(gone + most * u, 0)
    good = worst <= max(enough, 1e-12)
    if n > SAMPLED:
        sums = values.sum(axis=1) + gone.sum(axis=0)
        share = np.divide(area, sums, out=np.ones(n), where=sums > 0)
        values *= share[:, None]
        gone = gone * share
    left, gone_left = _left(kept, most)  # what is zero may be more, and others of its row then less
    np.copyto(left, kept, where=variances == 0)
    left[own] *= 2
    return Measured(values, left, gone, gone_left, area), good


def _multipliers(variances: np.ndarray, gone: np.ndarray, lacking: np.ndarray) -> np.ndarray:
    """Return the multipliers of groups by which rows come to what they lack, (n,): conjugate gradients."""
    whole = variances.sum(axis=1, dtype=np.float64) + gone
    diagonal = whole + variances.diagonal()
    diagonal = np.where(diagonal > 0, diagonal, 1.0)
    u, rest = np.zeros(len(lacking)), lacking.copy()
    ready = rest / diagonal
    way, rise = ready, float(rest @ ready)
    first = rise
    for _ in range(PRODUCTS):
        if not rise > ENOUGH**2 * first:
            break
        product = whole * way + variances @ way.astype(variances.dtype)
        bend = float(way @ product)
        if not bend > 0:
            break
        u = u + rise / bend * way
        rest = rest - rise / bend * product
        ready = rest / diagonal
        new = float(rest @ ready)
        way, rise = ready + new / rise * way, new
    return u


def _left(variances: np.ndarray, gone: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the variances that are left when rows must close: v (1 - v (share of both rows)), (n, n) and (2, n).

    Args:
        variances: those of what was measured; of what a group sends to itself half of it.
        gone: (2, n) of what escapes and is lost.
    """
    n, slack = len(variances), variances.sum(axis=1, dtype=np.float64) + variances.diagonal() + gone.sum(axis=0)
    if n <= EXACTLY:
        matrix = variances + np.diag(slack - variances.diagonal())
        root = np.sqrt(np.where(slack > 0, slack, 1.0))
        inverse = np.linalg.inv(matrix / root[:, None] / root + REGULAR * np.eye(n)) / root[:, None] / root
        along = inverse.diagonal()[:, None] + inverse.diagonal() + 2 * inverse
        along[np.diag_indices(n)] /= 2  # what a group sends to itself counts once, by half the variance that it has here
        return np.maximum(variances * (1 - variances * along), 0), np.maximum(gone * (1 - gone * inverse.diagonal()), 0)
    share = np.divide(1, slack, out=np.zeros(n), where=slack > 0)
    left = np.empty_like(variances)
    for at in range(0, n, step := max((1 << 20) // n, 1)):
        rows = slice(at, at + step)
        np.multiply((share[rows, None] + share).astype(variances.dtype), variances[rows], out=left[rows])
        np.clip(1 - left[rows], 0, 1, out=left[rows])
        left[rows] *= variances[rows]
    return left, np.maximum(gone * (1 - gone * share), 0)
