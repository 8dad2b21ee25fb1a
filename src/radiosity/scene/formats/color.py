"""CIE chromaticities to linear RGB of Radiance's standard primaries, whose white is equal-energy grey."""

from functools import cache

import numpy as np

PRIMARIES = ((0.640, 0.330), (0.290, 0.600), (0.150, 0.060))  # (x, y) of red, green, blue
NEUTRAL = 5e-4  # distance from (1/3, 1/3) that rounding to three digits can make


@cache
def _from_xyz() -> np.ndarray:
    columns = np.array([[x / y, 1.0, (1 - x - y) / y] for x, y in PRIMARIES]).T
    return np.linalg.inv(columns * np.linalg.solve(columns, np.ones(3)))  # (X, Y, Z) = (1, 1, 1) becomes white


@cache
def luminance_weights() -> np.ndarray:
    """Return the share of red, green and blue in the luminance of white, (3,): about 0.265, 0.670, 0.065."""
    return np.linalg.inv(_from_xyz())[1]


def is_neutral(x: float, y: float) -> bool:
    """Return whether a chromaticity is grey."""
    return max(abs(x - 1 / 3), abs(y - 1 / 3)) < NEUTRAL


def unit_rgb(x: float, y: float) -> np.ndarray:
    """Return the RGB of luminance 1 of a chromaticity, (3,). Grey has three equal values; ``y`` must be positive.

    A colour outside the triangle of primaries is moved towards grey of equal luminance until no value is negative.
    """
    rgb = np.ones(3) if is_neutral(x, y) else _from_xyz() @ (x / y, 1.0, (1 - x - y) / y)
    least = rgb.min()
    return np.maximum(1 + (rgb - 1) / (1 - least), 0.0) if least < 0 else rgb


def chromaticity(rgb: np.ndarray) -> tuple[float, float]:
    """Return the chromaticity (x, y) of a colour, (3,), that is not black."""
    xyz = np.linalg.solve(_from_xyz(), rgb)
    return float(xyz[0] / xyz.sum()), float(xyz[1] / xyz.sum())
