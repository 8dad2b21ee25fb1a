"""The error of sensors that a run is to reach."""

import numpy as np

from .model import Sensors

OF = ("mean", "worst")
LEVEL = 0.95
DARK = 1e-9  # of the brightest sensor: darker ones have no relative error


def half_width(values: np.ndarray, level: float = LEVEL) -> np.ndarray:
    """Return half the width of Student's interval of means over replicates, from (replicates, ...) values; NaN with one."""
    from scipy.special import stdtrit

    count = len(values)
    if count < 2:
        return np.full(values.shape[1:], np.nan)
    return stdtrit(count - 1, (1 + level) / 2) * values.std(axis=0, ddof=1) / count**0.5


def worst(values: np.ndarray, sensors: Sensors, of: str, inside: np.ndarray) -> float:
    """Return the largest relative error, for 95 % of runs: of means of sets, or of sensors. NaN with one replicate.

    It is infinite where no line found light: such an error cannot be judged.

    Args:
        values: (replicates, n_sensors, k).
        of: one of `OF`.
        inside: (n_sensors,) bool, sensors that do not count.
    """
    values, sets = values[:, ~inside], sensors.set[~inside]
    if not len(sets):
        return 0.0
    if of == "mean":
        number = np.bincount(sets, minlength=len(sensors.names))
        sums = np.stack([np.stack([np.bincount(sets, column, len(number)) for column in one.T], -1) for one in values])
        values = sums / np.maximum(number, 1)[:, None]
    mean, width = values.mean(axis=0), half_width(values)
    bright = mean > DARK * max(float(mean.max()), 1e-300)
    return float((width[bright] / mean[bright]).max()) if bright.any() else np.inf


def achieved(measured, of: str) -> tuple[str, float]:
    """Return what the error is of, in words, and the error of a measurement."""
    words = {"mean": "the mean of a set of sensors", "worst": "the worst sensor"}[of]
    return words, worst(measured.values, measured.sensors, of, measured.inside)
