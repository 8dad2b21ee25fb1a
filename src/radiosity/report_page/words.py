"""The words and numbers of a report: lux and candela where the scene is photometric, watts where it is not."""

import math
from dataclasses import dataclass

import numpy as np

from ..image import tone
from ..scene.model import Scene
from ..scene.photopic import photopic

UNKNOWN = "unknown"


@dataclass(frozen=True)
class Words:
    """What the quantities of a scene are called, and their units."""

    falling: str  # light that falls on a surface
    falling_unit: str
    leaving: str  # light that leaves it, in a direction
    leaving_unit: str
    power: str
    power_unit: str

    @staticmethod
    def of(scene: Scene) -> "Words":
        """Make the words of a scene."""
        if scene.photometric:
            return Words("illuminance", "lx", "luminance", "cd/m²", "luminous flux", "lm")
        return Words("irradiance", "W/m²", "radiance", "W/(m² sr)", "radiant power", "W")


def single(scene: Scene, values: np.ndarray) -> np.ndarray:
    """Return one number for all bands, (..., n_bands) to (...): lux by photopic weights, or the mean that pictures show."""
    if values.shape[-1] == 1:
        return values[..., 0]
    found = photopic(scene, values)
    return tone.luminance(values) if found is None else found


def total(scene: Scene, values: np.ndarray) -> np.ndarray:
    """Return a power of all bands, (..., n_bands) to (...): lumens by photopic weights, or the sum of watts."""
    found = photopic(scene, values)
    return values.sum(axis=-1) if found is None else found


def number(value: float) -> str:
    """Return a number with three digits, as people read it."""
    value = float(value)
    if not math.isfinite(value):
        return UNKNOWN
    if value == 0:
        return "0"
    rounded = round(value, 2 - math.floor(math.log10(abs(value))))
    digits = 2 - math.floor(math.log10(abs(rounded)))  # rounding may have made one more before the point
    if abs(rounded) >= 1e6 or abs(rounded) < 1e-3:
        return f"{value:.2e}"
    return f"{rounded:,.{max(digits if abs(rounded) < 100 else 0, 0)}f}"


def percent(share: float) -> str:
    """Return a share in percent with two digits; more than all of it is only called so."""
    if share > 1:
        return "over 100 %"
    return f"{100 * share:.2g} %" if math.isfinite(share) else UNKNOWN
