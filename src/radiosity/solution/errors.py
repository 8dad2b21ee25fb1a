"""Errors from replicates (contract 5)."""

import numpy as np

SURE = 0.95  # of runs are to reach the error that was asked for
BLOCK = 1 << 16  # columns
MANY = 1e5  # independent patches: more make no difference


def mean_and_error(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard error of the mean over axis 0 (replicates); the error of a single replicate is unknown: NaN."""
    count = len(values)
    mean = np.zeros(values.shape[1:])
    for row in values:  # row by row: no copy of all replicates in double precision
        mean += row
    mean /= count
    if count < 2:
        return mean, np.full(mean.shape, np.nan)
    squares = np.zeros(mean.shape)
    for row in values:
        squares += (row - mean) ** 2
    return mean, np.sqrt(squares / (count * (count - 1)))


def margin(spread: np.ndarray, replicates: int) -> float:
    """How many times the stated RMS error of many patches the true one may be, with probability `SURE`.

    Patches of a run share its numbers, so their errors go together: they are worth as many independent ones as
    nu = (tr C)^2 / tr C^2, C the covariance of the patches' values. Then the true mean square over the stated one follows
    F(nu, nu (R - 1)), which for a single patch is the square of Student's t. tr C and tr C^2 are estimated from the inner
    products of the replicates, without bias where values are normal.

    Args:
        spread: (replicates, replicates) inner products of the replicates' deviations from their mean.
    """
    from scipy.stats import f

    free = replicates - 1
    if free < 1 or not spread.trace() > 0:
        return 1.0
    trace, square = spread.trace() / free, (spread**2).sum() / free**2
    square = (square - trace**2 / free) * free**2 / max((free - 1) * (free + 2), 1)
    of_trace = trace**2 - 2 * square / free
    nu = float(np.clip(of_trace / square if square > 0 else MANY, 1.0, MANY))
    return float(np.sqrt(f.ppf(SURE, nu, nu * free)))


def inner_products(values: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """(replicates, replicates) of the weighted deviations of (replicates, n) values from their mean, block by block of
    columns."""
    total = np.zeros((len(values), len(values)))
    for at in range(0, values.shape[1], BLOCK):
        part = values[:, at : at + BLOCK].astype(np.float64) * weight[at : at + BLOCK]
        part -= part.mean(axis=0)
        total += part @ part.T
    return total


def relative_error(value: np.ndarray, error: np.ndarray, area: np.ndarray, fallback: tuple[np.ndarray, np.ndarray]) -> float:
    """Area-weighted RMS of the error over area-weighted RMS of the value, the largest of the bands; NaN where unknown.

    Args:
        value, error: (n_patches, n_bands) of B - E, its standard error.
        area: (n_patches,).
        fallback: irradiance and its error, used where B - E is zero in every patch and band.
    """
    if not value.any():
        value, error = fallback
    top = np.sqrt(area @ error**2)
    bottom = np.sqrt(area @ value**2)
    lit = bottom > 0
    return float((top[lit] / bottom[lit]).max()) if lit.any() else float("nan")
