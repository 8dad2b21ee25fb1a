"""Tone curves: they turn linear light, in display units, into the numbers of an 8-bit picture.

`clip` can be undone. The other two roll bright light off, as film does, so that lamps and sunlit places keep a shape.
"""

from collections.abc import Callable

import numpy as np

from ..errors import OutputError
from . import tone

GREY, DISPLAYED = 0.18, 0.4614  # middle grey in linear light, and as it is displayed: the same as by `clip`
STOPS = (-10.0, 6.5)  # about middle grey: what `agx` shows
SLOPE = 2.3  # of its sigmoid: near one at middle grey, on a logarithmic scale
MIXED = 0.12  # of each colour that goes to the two others: bright colours become pale before they clip


def filmic(linear: np.ndarray) -> np.ndarray:
    """Roll off as K. Narkowicz's fit of the ACES reference does ("ACES Filmic Tone Mapping Curve", 2015): much contrast.

    The fit takes 0.7 of the light, so that middle grey keeps about its tone.
    """
    x = 0.7 * np.maximum(linear, 0)
    return tone.srgb(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14))


def agx(linear: np.ndarray) -> np.ndarray:
    """Roll off like AgX (T. Sobotka): colours are mixed a little, and a sigmoid of the logarithm leads from black to white."""
    x = np.maximum(linear, 0)
    x = (1 - 1.5 * MIXED) * x + 0.5 * MIXED * x.sum(axis=-1, keepdims=True)
    low, high = STOPS
    part = np.clip((np.log2(np.maximum(x, 1e-12) / GREY) - low) / (high - low), 0, 1)
    middle = -low / (high - low)
    rest = ((middle / (1 - middle)) ** SLOPE) * (1 - DISPLAYED) / DISPLAYED
    return part**SLOPE / (part**SLOPE + rest * (1 - part) ** SLOPE)


CURVES: dict[str, Callable[[np.ndarray], np.ndarray]] = {"clip": tone.srgb, "filmic": filmic, "agx": agx}
WORDS = {
    "clip": "sRGB of value x scale, clipped to 1",
    "filmic": "filmic roll-off of value x scale",
    "agx": "AgX-like roll-off of value x scale",
}


def checked(name: str) -> str:
    """Return the name of a curve.

    Raises:
        OutputError: there is no such curve.
    """
    if name not in CURVES:
        raise OutputError(f"tone_map is '{name}'; known are {', '.join(CURVES)}")
    return name


def displayed(values: np.ndarray, scale: float, name: str = "clip") -> np.ndarray:
    """Return the 8-bit colours, (..., 3), of values, (..., n_bands).

    Args:
        scale: linear display value for one unit.
        name: of a curve.
    """
    return tone.eight_bits(CURVES[name](np.nan_to_num(tone.colours(values) * scale)))
