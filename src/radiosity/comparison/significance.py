"""Tests of differences between two means of independent replicates.

A single difference is tested by Welch's t with Welch's degrees of freedom (B. L. Welch, "The generalization of 'Student's'
problem when several different population variances are involved", Biometrika 34, 1947). Its normal score is as rare as that t.
Many differences together are tested by chi square, the sum of the squares of their scores. Rows of a run share its lines, so they
are correlated: they count as nu = (tr C)² / tr C² independent ones, where C is the correlation that the replicates show (as in
`solution.errors.margin`).
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Test:
    """The test of each of many differences.

    Attributes:
        score: the difference as a normal score: +2 is as rare as +2 standard deviations of a normal distribution. NaN: unknown.
        chance: the probability of a difference as large by chance alone; NaN where unknown.
    """

    score: np.ndarray
    chance: np.ndarray


def welch(difference: np.ndarray, errors, replicates) -> Test:
    """Test differences of two means, by shapes of ``difference``.

    Args:
        difference: the first mean less the second.
        errors: two arrays of standard errors; NaN where unknown.
        replicates: two numbers of replicates, or None for a mean that is exact.
    """
    from scipy.stats import norm, t

    squares = [np.square(error) for error in errors]
    total = squares[0] + squares[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        below = sum(s**2 / max(count - 1, 1) for s, count in zip(squares, replicates, strict=True) if count is not None)
        free = np.where(below > 0, total**2 / below, 1.0)
        chance = 2 * t.sf(np.abs(difference) / np.sqrt(total), free)
    chance = np.where(total == 0, np.where(difference == 0, 1.0, 0.0), chance)
    score = np.sign(difference) * norm.isf(np.maximum(chance, np.finfo(float).tiny) / 2)
    return Test(np.where(np.isnan(chance), np.nan, score), chance)


def any_of(chance: np.ndarray) -> float:
    """The probability that the least of many chances is as small by chance alone (Šidák); NaN where all are unknown."""
    known = chance[np.isfinite(chance)]
    return float(-np.expm1(known.size * np.log1p(-min(known.min(), 1 - 1e-16)))) if known.size else float("nan")


def chi_square(score: np.ndarray, error: np.ndarray, spreads) -> tuple[float, float, float]:
    """Test many differences together.

    Args:
        score: (k,) normal scores; NaN where a difference is not tested.
        error: (k,) standard errors of the differences.
        spreads: of each solution that has replicates, (replicates, k) values.

    Returns:
        chi square over the number of tested differences, the number nu of independent ones that count, and the probability of a
        chi square as large by chance alone. NaN where there is nothing to test.
    """
    from scipy.stats import chi2

    some = np.isfinite(score) & (error > 0) & np.all([np.isfinite(values).all(axis=0) for values in spreads], axis=0)
    if not some.any():
        return float("nan"), float("nan"), float("nan")
    mean = float(np.mean(score[some] ** 2))
    parts = [_standardised(values[:, some], error[some]) for values in spreads]
    traces = [float((part**2).sum()) for part in parts]
    square = 2 * float(((parts[0] @ parts[1].T) ** 2).sum()) if len(parts) == 2 else 0.0
    for part, trace in zip(parts, traces, strict=True):
        free = len(part) - 1
        own = float(((part @ part.T) ** 2).sum())
        square += (own - trace**2 / free) * free**2 / max((free - 1) * (free + 2), 1)
    count = int(some.sum())
    nu = float(np.clip(sum(traces) ** 2 / square if square > 0 else count, 1.0, count))
    return mean, nu, float(chi2.sf(nu * mean, nu))


def _standardised(values: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Deviations of replicates whose inner products are covariances of the means, in units of the errors, (replicates, k)."""
    count = len(values)
    return (values - values.mean(axis=0)) / error / np.sqrt(count * (count - 1))
