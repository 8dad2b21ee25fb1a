"""Errors from replicates (contract 5)."""

import numpy as np

from ..patches.scatter import Scatter
from ..pieces import pieces

SURE = 0.95  # share of runs that must reach the error that was asked for
MANY = 1e5  # number of independent patches above which more make no difference


def mean_and_error(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard error of the mean over axis 0 (replicates); the error of a single replicate is unknown: NaN."""
    mean, error = (np.empty(values.shape[1:]) for _ in range(2))
    for part in pieces(len(mean)):
        mean[part], error[part] = _mean_and_error(values[:, part])
    return mean, error


def _mean_and_error(values: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
    count = len(values)
    mean, squares = (np.zeros(values.shape[1:]) for _ in range(2))
    for row in values:  # row by row: no copy of all replicates in double precision
        mean += row
    mean /= count
    if count < 2:
        return mean, np.nan
    for row in values:
        squares += (row - mean) ** 2
    return mean, np.sqrt(squares / (count * (count - 1)))


def margin(spread: np.ndarray, replicates: int) -> float:
    """The factor by which the true RMS error of many patches may exceed the stated one, with probability `SURE`.

    Patches of a run share its numbers, so their errors are correlated. They count as nu = (tr C)^2 / tr C^2 independent
    patches, where C is the covariance of the patches' values. Then the true mean square over the stated one follows
    F(nu, nu (R - 1)), which for a single patch is the square of Student's t. tr C and tr C^2 are estimated from the inner
    products of the replicates, without bias where values are normal.

    Args:
        spread: (replicates, replicates) inner products of the replicates' deviations from their mean.
    """
    from scipy.special import fdtri  # `scipy.stats` has the same, and takes half a second to import

    free = replicates - 1
    if free < 1 or not spread.trace() > 0:
        return 1.0
    trace, square = spread.trace() / free, (spread**2).sum() / free**2
    square = (square - trace**2 / free) * free**2 / max((free - 1) * (free + 2), 1)
    of_trace = trace**2 - 2 * square / free
    nu = float(np.clip(of_trace / square if square > 0 else MANY, 1.0, MANY))
    return float(np.sqrt(fdtri(nu, nu * free, SURE)))


def inner_products(values: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """The inner products of the weighted deviations of (replicates, n) values from their mean, (replicates, replicates).

    They are summed block by block of columns.
    """
    total = np.zeros((len(values), len(values)))
    for part in pieces(values.shape[1]):
        weighted = values[:, part].astype(np.float64) * weight[part]
        weighted -= weighted.mean(axis=0)
        total += weighted @ weighted.T
    return total


def relative_error(reflectance: np.ndarray, irradiance: np.ndarray, error: np.ndarray, area: np.ndarray) -> float:
    """Area-weighted RMS of the error of B - E over that of B - E, the largest of the bands.

    Where nothing reflects, it is the relative error of the irradiance. It is NaN where it is unknown, for example where no line
    hit in a band that has an error.

    Args:
        reflectance, irradiance, error: (n_patches, n_bands); ``error`` is the error of the irradiance.
        area: (n_patches,).
    """
    for weight in (reflectance, np.broadcast_to(1.0, reflectance.shape)):
        top, bottom = np.zeros((2, reflectance.shape[1]))
        for part in pieces(len(area)):
            rho = weight[part]
            bottom += area[part] @ (rho * irradiance[part]) ** 2
            top += area[part] @ np.where(rho == 0, 0.0, rho * error[part]) ** 2
        lit, blind = bottom > 0, (bottom == 0) & (top > 0)
        if lit.any() or blind.any():
            return float("nan") if blind.any() else float((np.sqrt(top[lit]) / np.sqrt(bottom[lit])).max())
    return float("nan")


def relative_error_of(
    scatter: Scatter, irradiance: np.ndarray, error: np.ndarray, area: np.ndarray, rows: np.ndarray | slice = slice(None)
) -> float:
    """Return the `relative_error` of some patches. Errors of both sides of diffusing panes are added.

    Args:
        scatter: what patches send on of the light that they receive.
        rows: the patches that count.
    """
    if scatter.through is None:
        return relative_error(scatter.reflectance[rows], irradiance[rows], error[rows], area[rows])
    sent, wrong = scatter.of(irradiance)[rows], scatter.error_of(error)[rows]
    if not (sent.any() or wrong.any()):
        sent, wrong = irradiance[rows], error[rows]
    return relative_error(np.ones(sent.shape), sent, wrong, area[rows])
