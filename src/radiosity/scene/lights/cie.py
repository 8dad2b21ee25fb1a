"""The skies of the CIE, as radiances relative to anything.

- The overcast sky (Moon and Spencer 1942; ISO 15469:2004, type 16): L is in proportion to 1 + 2 sin of the altitude.
- The general sky (ISO 15469:2004, CIE S 011:2003): L is in proportion to f(angle to the sun) g(altitude), with
  g = 1 + a exp(b / sin altitude) and f = 1 + c (exp(d x) - exp(d pi / 2)) + e cos² x, and five numbers for each of 15 types.
- The clear sky (CIE 22-1973, R. Kittler 1967) is type 12 of it: 1 - 10 exp(-3 pi / 2) is the 0.91 of its formula.
- The intermediate sky (H. Nakamura, M. Oki, Y. Hayashi 1985; K. Matsuura 1987), as EnergyPlus's Engineering Reference has it.
"""

from collections.abc import Callable

import numpy as np

GENERAL = {  # a, b, c, d, e
    1: (4.0, -0.70, 0.0, -1.0, 0.0),
    2: (4.0, -0.70, 2.0, -1.5, 0.15),
    3: (1.1, -0.80, 0.0, -1.0, 0.0),
    4: (1.1, -0.80, 2.0, -1.5, 0.15),
    5: (0.0, -1.00, 0.0, -1.0, 0.0),
    6: (0.0, -1.00, 2.0, -1.5, 0.15),
    7: (0.0, -1.00, 5.0, -2.5, 0.30),
    8: (0.0, -1.00, 10.0, -3.0, 0.45),
    9: (-1.0, -0.55, 2.0, -1.5, 0.15),
    10: (-1.0, -0.55, 5.0, -2.5, 0.30),
    11: (-1.0, -0.55, 10.0, -3.0, 0.45),
    12: (-1.0, -0.32, 10.0, -3.0, 0.45),
    13: (-1.0, -0.32, 16.0, -3.0, 0.30),
    14: (-1.0, -0.15, 16.0, -3.0, 0.30),
    15: (-1.0, -0.15, 24.0, -2.8, 0.15),
}
CLEAR = 12
NO_SUN = (1, 3, 5)  # types that look the same in all azimuths


def overcast(altitude: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """Return the radiance of the overcast sky, relative to three zeniths."""
    return 1 + 2 * np.sin(altitude)


def general(kind: int, sun: tuple[float, float]) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return the relative radiance of a type of the general sky, a function of altitudes and azimuths, rad.

    Args:
        sun: its altitude and azimuth, rad.
    """
    a, b, c, d, e = GENERAL[kind]

    def relative(altitude: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
        cosine = cosine_to(sun, altitude, azimuth)
        gradation = 1 + a * np.exp(b / np.maximum(np.sin(altitude), 1e-6))
        return gradation * (1 + c * (np.exp(d * np.arccos(cosine)) - np.exp(d * np.pi / 2)) + e * cosine**2)

    return relative


def intermediate(sun: tuple[float, float]) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return the relative radiance of the intermediate sky; see `general`."""

    def relative(altitude: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
        angle = np.arccos(cosine_to(sun, altitude, azimuth))
        level = 1.35 * (np.sin(3.59 * altitude - 0.009) + 2.31) * np.sin(2.60 * sun[0] + 0.316) + altitude + 4.799
        return level * np.exp(-0.563 * angle * ((sun[0] - 0.008) * (altitude + 1.059) + 0.812))

    return relative


def cosine_to(sun: tuple[float, float], altitude: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """Return the cosine of the angle to the sun, of altitudes and azimuths, rad."""
    height, turn = sun
    cosine = np.sin(height) * np.sin(altitude) + np.cos(height) * np.cos(altitude) * np.cos(azimuth - turn)
    return np.clip(cosine, -1, 1)
