"""The skies of Perez and the suns of a year, as radiances of sky patches."""

from dataclasses import dataclass

import numpy as np

from ...errors import SceneError
from ..habits import warn
from .axes import towards
from .perez import BRIGHTNESS, Weather
from .sky_patches import SkyPatches
from .weather_year import WeatherYear


@dataclass(frozen=True, eq=False)
class YearOfSkies:
    """The light of each hour of a year that has some.

    Attributes:
        hours: (n,) int64, their numbers in the year.
        radiance: (n, n_sky_patches) float64, the mean of each sky patch, cd/m²; the last one is the ground.
        direct: (n,) float64, lm/m² across the sun's light.
        towards: (n, 3) float64, unit directions to the sun.
        sun: (n, 2) float64, its altitude and azimuth, rad.
    """

    hours: np.ndarray
    radiance: np.ndarray
    direct: np.ndarray
    towards: np.ndarray
    sun: np.ndarray

    @staticmethod
    def of(year: WeatherYear, patches: SkyPatches, axes: np.ndarray, ground: float) -> "YearOfSkies":
        """Make the skies of a year. Each has exactly the diffuse irradiance of the weather, in lm/m² by Perez's efficacies.

        Args:
            axes: (3, 3) directions of north, east and up.
            ground: share of the horizontal irradiance that the ground below the horizon reflects.

        Raises:
            SceneError: ground is out of range, or no hour has light.
        """
        if not 0 <= ground <= 1:
            raise SceneError(f"ground is {ground}; it is the reflectance below the horizon, 0 to 1")
        hours = np.flatnonzero(year.diffuse > 0)
        if not len(hours):
            raise SceneError(f"{year.source}: the sky gives no light in any hour (all diffuse irradiances are 0)")
        altitude, azimuth = (places[hours] for places in year.sun)
        below, kept = altitude <= 0, np.maximum(altitude, 0.0)
        sun = np.radians(np.column_stack([kept, azimuth]))
        radiance, direct = np.zeros((len(hours), len(patches))), np.zeros(len(hours))
        bright, formless = 0, 0
        for number, hour in enumerate(hours.tolist()):
            place = (float(sun[number, 0]), float(sun[number, 1]))
            beam, diffuse = float(year.direct[hour]), float(year.diffuse[hour])
            weather = Weather(beam, diffuse, place, float(year.day[hour]), float(year.dew_point[hour]))
            upper = np.maximum(weather.relative()(*patches.samples), 0).mean(axis=1)
            received = upper @ patches.horizontal[:-1]
            bright += weather.brightness > BRIGHTNESS[1]
            if not received > 0:
                formless += 1
                upper, received = np.ones(len(upper)), np.pi
            of_direct, of_diffuse = weather.lumens
            radiance[number, :-1] = upper * (diffuse * of_diffuse / received)
            direct[number] = 0.0 if below[number] else beam * of_direct
            whole = diffuse * of_diffuse + direct[number] * np.sin(place[0])
            radiance[number, -1] = ground * whole / np.pi
        _tell(year, int(below.sum()), bright, formless, int(((year.direct > 0) & (year.diffuse <= 0)).sum()))
        ways = np.array([towards(axes, *pair) for pair in zip(kept.tolist(), azimuth.tolist(), strict=True)])
        return YearOfSkies(hours, radiance, direct, ways, sun)

    def with_suns(self, patches: SkyPatches) -> np.ndarray:
        """Return radiances with the sun's light spread over the patch that it stands in, (n, n_sky_patches)."""
        found, number = self.radiance.copy(), patches.number(*self.sun.T)
        found[np.arange(len(found)), number] += self.direct / patches.solid_angle[number]
        return found


def _tell(year: WeatherYear, below: int, bright: int, formless: int, dark: int) -> None:
    """Tell once a kind in how many hours the formula of Perez has no answer of its own."""
    for count, what in (
        (below, "have light with the sun below the horizon; the sky is as if it stood on it, and direct light is left out"),
        (bright, f"have more diffuse light than any measured; the shape is that of brightness {BRIGHTNESS[1]}"),
        (formless, "have a sky for which the formula of Perez gives no light; it is uniform there"),
        (dark, "have direct light without any diffuse light; they count as dark"),
    ):
        if count:
            warn(f"{year.source}: {count} hours {what}")
