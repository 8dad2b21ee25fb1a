"""Slopes of error against lines, with intervals from replicates."""

from dataclasses import dataclass

import numpy as np

DECADES = 2  # at the end of the ladder


@dataclass(frozen=True)
class Slope:
    """A fitted exponent.

    Attributes:
        value: mean over replicates.
        half: half of its 95 % interval (Student over replicates).
    """

    value: float
    half: float

    @property
    def low(self) -> float:
        return self.value - self.half

    @property
    def high(self) -> float:
        return self.value + self.half

    def __str__(self) -> str:
        return f"{self.value:.2f} ± {self.half:.2f}"


def fit(lines: np.ndarray, errors: np.ndarray) -> Slope:
    """Fit log error against log lines by least squares over the last two decades, replicate by replicate.

    Args:
        lines: (k,) increasing. errors: (replicates, k).
    """
    from scipy.stats import t

    last = (lines >= lines[-1] / 10**DECADES) & (errors > 0).all(axis=0)
    if last.sum() < 3:
        return Slope(float("nan"), float("nan"))
    x, y = np.log(lines[last]), np.log(errors[:, last])
    x = x - x.mean()
    slopes = y @ x / (x @ x)
    count = len(slopes)
    return Slope(float(slopes.mean()), float(t.ppf(0.975, count - 1) * slopes.std(ddof=1) / np.sqrt(count)))


def mean_error(errors: np.ndarray) -> np.ndarray:
    """Return the root mean square over replicates, (k,)."""
    return np.sqrt((errors**2).mean(axis=0))


def ratio(one: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """Return the geometric mean of the ratio of errors at the last rung, and the factor within which it is known (95 %,
    Welch)."""
    from scipy.stats import t

    a, b = np.log(one[:, -1]), np.log(other[:, -1])
    spread = np.sqrt(a.var(ddof=1) / len(a) + b.var(ddof=1) / len(b))
    return float(np.exp(a.mean() - b.mean())), float(np.exp(t.ppf(0.975, len(a) + len(b) - 2) * spread))
