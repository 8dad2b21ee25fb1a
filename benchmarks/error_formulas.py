"""Formulas of ``make bench-error``: relative errors against a reference, and the time that a ladder of runs takes to a target.

Only numpy is used, and nothing of the package, so that the code of every commit is judged alike.
"""

from dataclasses import dataclass

import numpy as np

UNKNOWN = float("nan")


def squares(reflectance: np.ndarray, area: np.ndarray, values: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Area-weighted mean square of (B - E) - truth over that of the truth's B - E, (n_bands,): `Solution.error`, squared.

    Args:
        reflectance: (n_patches, n_bands).
        area: (n_patches,).
        values, truth: (n_patches, n_bands) irradiance.
    """
    return area @ (reflectance * (values - truth)) ** 2 / (area @ (reflectance * truth) ** 2)


def surface_means(reflectance: np.ndarray, area: np.ndarray, surface: np.ndarray, irradiance: np.ndarray):
    """Areas of surfaces, (n_surfaces,), and means of B - E over them, (n_surfaces, n_bands), without surfaces of no area."""
    total = np.bincount(surface, area)
    some = total > 0
    power = [np.bincount(surface, area * band) for band in (reflectance * irradiance).T]
    return total[some], np.stack(power, axis=1)[some] / total[some, None]


def means_squares(area: np.ndarray, values: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """The mean square of surface means' errors over that of the means, surfaces weighted by their area, (n_bands,)."""
    return area @ (values - truth) ** 2 / (area @ truth**2)


def rms(runs, variance) -> float:
    """Relative RMS error of several runs, the largest of the bands, less the reference's own variance.

    Args:
        runs: (runs, n_bands) squares of relative errors.
        variance: (n_bands,) the reference's.
    """
    return float(np.sqrt(np.max(np.maximum(np.mean(runs, axis=0) - variance, 0.0))))


@dataclass(frozen=True)
class Time:
    """Seconds to an error. ``mark`` is "" (between two runs), "*" (extrapolated) or "<" (the smallest run is better)."""

    seconds: float
    mark: str = ""

    def __str__(self) -> str:
        """Three digits and the mark; "-" where unknown."""
        if not np.isfinite(self.seconds):
            return "-"
        number = f"{self.seconds:.3g}"
        return f"<{number}" if self.mark == "<" else number + self.mark


def time_to(target: float, errors, seconds) -> Time:
    """Return the seconds after which the error stays below the target, by straight lines in logarithms.

    Args:
        errors, seconds: of runs of growing size. The last run above the target and the next one are joined. Where all are above,
            the line through the last two is drawn on; where that one does not fall, the time is unknown.
    """
    errors, seconds = (np.asarray(values, float) for values in (errors, seconds))
    if not len(errors) or not np.isfinite(errors).all():
        return Time(UNKNOWN)
    above = np.flatnonzero(errors > target)
    if not len(above):
        return Time(float(seconds[0]), "<")
    last = int(above[-1])
    if last + 1 < len(errors):
        return Time(_on_line(target, errors[last : last + 2], seconds[last : last + 2]))
    if len(errors) < 2 or errors[-1] >= errors[-2]:
        return Time(UNKNOWN)
    return Time(_on_line(target, errors[-2:], seconds[-2:]), "*")


def error_at(time: float, errors, seconds) -> float:
    """Return the error after a time, by straight lines in logarithms; NaN outside of what was measured."""
    order = np.argsort(seconds)
    errors, seconds = np.asarray(errors, float)[order], np.asarray(seconds, float)[order]
    if not len(errors) or not seconds[0] <= time <= seconds[-1]:
        return UNKNOWN
    return float(np.exp(np.interp(np.log(time), np.log(seconds), np.log(np.maximum(errors, 1e-12)))))


def _on_line(target: float, errors, seconds) -> float:
    one, two = np.log(np.maximum(errors, 1e-12))
    share = (np.log(target) - one) / (two - one)
    return float(np.exp(np.log(seconds[0]) + share * (np.log(seconds[1]) - np.log(seconds[0]))))
