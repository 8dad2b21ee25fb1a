"""Formulas of ``make bench-heat``. Only numpy is used, and nothing of this package."""

import numpy as np


def square(factors: np.ndarray, truth: np.ndarray) -> float:
    """The square of the error: sum over pairs of (F_ij - truth_ij)² over that of truth_ij²."""
    return float(((factors - truth) ** 2).sum() / (truth**2).sum())


def grouped(factors: np.ndarray, area: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Factors between groups of faces: rows are means weighted by area, columns are sums.

    Args:
        factors: (m, m), F_ij in row i.
        area: (m,) m².
        group: (m,) numbers from 0.
    """
    n = int(group.max()) + 1
    if n == len(group) and (group == np.arange(n)).all():
        return factors
    columns = np.zeros((len(factors), n))
    for j, values in zip(group, factors.T, strict=True):
        columns[:, j] += values
    found = np.zeros((n, n))
    np.add.at(found, group, area[:, None] * columns)
    return found / np.bincount(group, area)[:, None]


def weighted(runs: list[np.ndarray], variances: list[float]) -> tuple[np.ndarray, float]:
    """The mean of runs, weighted by the inverse of their variances, and its variance."""
    weights = 1 / np.array(variances)
    mean = sum(weight * run for weight, run in zip(weights / weights.sum(), runs, strict=True))
    return np.asarray(mean), float(1 / weights.sum())
