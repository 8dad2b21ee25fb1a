"""The sky of Perez for all weathers, from direct normal and diffuse horizontal irradiance, and how many lumens a watt of it has.

- R. Perez, R. Seals, J. Michalsky, "All-weather model for sky luminance distribution: preliminary configuration and validation",
  Solar Energy 50(3), 1993, 235-245, with its erratum, 51(5), 1993, 423: `COEFFICIENTS`, table 1, and equations 1 and 6 to 8.
- R. Perez, P. Ineichen, R. Seals, J. Michalsky, R. Stewart, "Modeling daylight availability and irradiance components from direct
  and global irradiance", Solar Energy 44(5), 1990, 271-289: clearness, brightness, efficacies (table 4), equations 1 to 3, 7, 8.
- F. Kasten, "A new table and approximation formula for the relative optical air mass", 1966.
- J. Spencer, "Fourier series representation of the position of the sun", Search 2(5), 1971: the distance of the sun.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .cie import cosine_to

SOLAR_CONSTANT = 1367.0  # W/m², as in the paper of 1990
EDGES = (1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2)  # between the eight classes of clearness
BRIGHTNESS = (0.01, 0.6)  # the range of the measurements that the model is fitted to; beyond it the formula makes no sense
LEAST = 1e-6  # of the sine of the altitude in exp(b / sine)
DEW_POINT = 11.0  # °C, which stands for 2 cm of water

# a1 to a4, b1 to b4, and so on, for each class of clearness
_TABLE = """
    1.3525 -0.2576 -0.2690 -1.4366  -0.7670 0.0007 1.2734 -0.1233  2.8000 0.6004 1.2375 1.0000
      1.8734 0.6297 0.9738 0.2809  0.0356 -0.1246 -0.5718 0.9938
    -1.2219 -0.7730 1.4148 1.1016  -0.2054 0.0367 -3.9128 0.9156  6.9750 0.1774 6.4477 -0.1239
      -1.5798 -0.5081 -1.7812 0.1080  0.2624 0.0672 -0.2190 -0.4285
    -1.1000 -0.2515 0.8952 0.0156  0.2782 -0.1812 -4.5000 1.1766  24.7219 -13.0812 -37.7000 34.8438
      -5.0000 1.5218 3.9229 -2.6204  -0.0156 0.1597 0.4199 -0.5562
    -0.5484 -0.6654 -0.2672 0.7117  0.7234 -0.6219 -5.6812 2.6297  33.3389 -18.3000 -62.2500 52.0781
      -3.5000 0.0016 1.1477 0.1062  0.4659 -0.3296 -0.0876 -0.0329
    -0.6000 -0.3566 -2.5000 2.3250  0.2937 0.0496 -5.6812 1.8415  21.0000 -4.7656 -21.5906 7.2492
      -3.5000 -0.1554 1.4062 0.3988  0.0032 0.0766 -0.0656 -0.1294
    -1.0156 -0.3670 1.0078 1.4051  0.2875 -0.5328 -3.8500 3.3750  14.0000 -0.9999 -7.1406 7.5469
      -3.4000 -0.1078 -1.0750 1.5702  -0.0672 0.4016 0.3017 -0.4844
    -1.0000 0.0211 0.5025 -0.5119  -0.3000 0.1922 0.7023 -1.6317  19.0000 -5.0000 1.2438 -1.9094
      -4.0000 0.0250 0.3844 0.2656  1.0468 -0.3788 -2.4517 1.4656
    -1.0500 0.0289 0.4260 0.3590  -0.3250 0.1156 0.7781 0.0025  31.0625 -14.5000 -46.1148 55.3750
      -7.2312 0.4050 13.3500 0.6234  1.5000 -0.6426 1.8564 0.5636
"""
COEFFICIENTS = np.array(_TABLE.split(), np.float64).reshape(8, 5, 4)

DIFFUSE_EFFICACY = np.array(  # of 1, water, cos of the sun's zenith angle, ln brightness
    [
        (97.24, -0.46, 12.00, -8.91),
        (107.22, 1.15, 0.59, -3.95),
        (104.97, 2.96, -5.53, -8.77),
        (102.39, 5.59, -13.95, -13.90),
        (100.71, 5.94, -22.75, -23.74),
        (106.42, 3.83, -36.15, -28.83),
        (141.88, 1.90, -53.24, -14.03),
        (152.23, 0.35, -45.27, -7.98),
    ]
)
DIRECT_EFFICACY = np.array(  # of 1, water, exp(5.73 zenith angle - 5), brightness
    [
        (57.20, -4.55, -2.98, 117.12),
        (98.99, -3.46, -1.21, 12.38),
        (109.83, -4.90, -1.71, -8.81),
        (110.34, -5.84, -1.99, -4.56),
        (106.36, -3.97, -1.75, -6.16),
        (107.19, -1.25, -1.51, -26.73),
        (105.75, 0.77, -1.26, -34.44),
        (101.18, 1.58, -1.10, -8.29),
    ]
)


@dataclass(frozen=True)
class Weather:
    """The state of the sky.

    Attributes:
        direct: normal irradiance by the sun, W/m².
        diffuse: horizontal irradiance by the sky, W/m², above 0.
        sun: its altitude, 0 to pi / 2, and its azimuth, rad.
        day: of the year, from 1 on; it gives the distance of the sun.
        dew_point: °C, of the air at the ground.
    """

    direct: float
    diffuse: float
    sun: tuple[float, float]
    day: float
    dew_point: float = DEW_POINT

    @property
    def zenith(self) -> float:
        """The angle between the zenith and the sun, rad."""
        return np.pi / 2 - self.sun[0]

    @property
    def clearness(self) -> float:
        """Perez's epsilon."""
        turned = 1.041 * self.zenith**3
        return ((self.diffuse + self.direct) / self.diffuse + turned) / (1 + turned)

    @property
    def brightness(self) -> float:
        """Perez's Delta."""
        return self.diffuse * air_mass(self.zenith) / (SOLAR_CONSTANT * nearness(self.day))

    @property
    def kind(self) -> int:
        """The class of clearness, 0 to 7."""
        return int(np.searchsorted(EDGES, self.clearness, side="right"))

    @property
    def parameters(self) -> tuple[float, float, float, float, float]:
        """The five numbers a to e of the formula."""
        zenith, kind = self.zenith, self.kind
        brightness = float(np.clip(self.brightness, *BRIGHTNESS))
        if 1.065 < self.clearness < 2.8:
            brightness = max(brightness, 0.2)  # the paper's bound, below which the fit has no data
        x = COEFFICIENTS[kind]
        a, b, c, d, e = (float(one) for one in x[:, 0] + x[:, 1] * zenith + brightness * (x[:, 2] + x[:, 3] * zenith))
        if kind == 0:
            c = float(np.exp((brightness * (x[2, 0] + x[2, 1] * zenith)) ** x[2, 2]) - x[2, 3])
            d = float(-np.exp(brightness * (x[3, 0] + x[3, 1] * zenith)) + x[3, 2] + brightness * x[3, 3])
        return a, min(b, 0.0), c, d, e  # with b above 0 the horizon would be infinitely bright

    @property
    def lumens(self) -> tuple[float, float]:
        """Lumens a watt of the direct light and of the diffuse light."""
        water = np.exp(0.07 * self.dew_point - 0.075)  # cm
        direct, diffuse = DIRECT_EFFICACY[self.kind], DIFFUSE_EFFICACY[self.kind]
        first = direct @ (1, water, np.exp(5.73 * self.zenith - 5), self.brightness)
        second = diffuse @ (1, water, np.cos(self.zenith), np.log(self.brightness))
        return max(float(first), 0.0), max(float(second), 0.0)

    def relative(self) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
        """Return the relative radiance, a function of altitudes and azimuths, rad."""
        a, b, c, d, e = self.parameters

        def radiance(altitude: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
            cosine = cosine_to(self.sun, altitude, azimuth)
            gradation = np.maximum(1 + a * np.exp(b / np.maximum(np.sin(altitude), LEAST)), 0)
            return gradation * np.maximum(1 + c * np.exp(d * np.arccos(cosine)) + e * cosine**2, 0)

        return radiance


def air_mass(zenith: float) -> float:
    """Return the relative optical air mass at an angle from the zenith, rad (Kasten 1966)."""
    return float(1 / (np.cos(zenith) + 0.15 * (93.885 - np.degrees(zenith)) ** -1.253))


def nearness(day: float) -> float:
    """Return the square of the mean distance of the sun over that of a day of the year (Spencer 1971)."""
    angle = 2 * np.pi * (day - 1) / 365
    first = 1.00011 + 0.034221 * np.cos(angle) + 0.00128 * np.sin(angle)
    return float(first + 0.000719 * np.cos(2 * angle) + 0.000077 * np.sin(2 * angle))
