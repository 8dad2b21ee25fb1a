"""Tones: physical values become display values by a scale, then the sRGB curve. Nothing is compressed, so it can be undone."""

from collections.abc import Callable

import numpy as np

from ..errors import OutputError
from ..scene.photopic import PHOTOPIC
from .look import Look

PERCENTILE, LEVEL = 97.0, 0.85  # the automatic scale takes this percentile of the strongest channel to this linear value


def srgb(linear: np.ndarray) -> np.ndarray:
    """Map linear values by the sRGB curve (IEC 61966-2-1), both clipped to [0, 1]; NaN becomes 0."""
    linear = np.clip(np.nan_to_num(linear, nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def eight_bits(display: np.ndarray) -> np.ndarray:
    """Round values in [0, 1] to uint8."""
    return (np.clip(display, 0, 1) * 255 + 0.5).astype(np.uint8)


def colours(values: np.ndarray) -> np.ndarray:
    """Turn bands, (..., n_bands), into colours, (..., 3): three are red, green, blue; one is grey; else their mean is grey."""
    if values.shape[-1] == 3:
        return values
    return np.repeat(luminance(values)[..., None], 3, axis=-1)


def luminance(values: np.ndarray) -> np.ndarray:
    """Return the luminance, (...), of (..., n_bands): three bands weighted as linear sRGB, otherwise the mean of the bands."""
    return values @ PHOTOPIC if values.shape[-1] == 3 else values.mean(axis=-1)


def automatic_scale(values: np.ndarray, weight: np.ndarray | None = None) -> float:
    """Return the scale that takes a high percentile of the lit values to a light tone; 1 where nothing is lit.

    Args:
        values: (m, n_bands), in any unit.
        weight: (m,), weight of each value (its area); default: all the same.
    """
    level = colours(values).max(axis=-1)  # not the luminance: a channel that clips alone changes the hue
    lit = np.isfinite(level) & (level > 0)
    if not lit.any():
        return 1.0
    level, weight = level[lit], np.ones(int(lit.sum())) if weight is None else weight[lit]
    order = np.argsort(level)
    total = np.cumsum(weight[order])
    at = np.searchsorted(total, PERCENTILE / 100 * total[-1])
    return LEVEL / float(level[order[min(at, len(order) - 1)]])


def chosen_scale(look: Look, automatic: Callable[[], float]) -> float:
    """Return the scale asked for, or else the automatic one, times two to the power of the exposure.

    Raises:
        OutputError: the scale is not positive, or the exposure is not a number of stops.
    """
    exposure, scale = look.exposure or 0.0, look.scale
    if not (np.isfinite(exposure) and abs(exposure) <= 100):
        raise OutputError(f"exposure is {exposure}; it must be a number of stops between -100 and 100")
    if scale is not None and not (np.isfinite(scale) and scale > 0):
        raise OutputError(f"scale is {scale}; it must be a positive number (display value for one unit)")
    return (automatic() if scale is None else float(scale)) * 2.0 ** float(exposure)
