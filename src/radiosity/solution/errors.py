"""Errors from replicates (contract 5)."""

import numpy as np


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
