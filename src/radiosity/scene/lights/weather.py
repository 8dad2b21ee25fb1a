"""Skies of the weather: from irradiances, and from an hour of a weather file (docs/daylight.md)."""

from os import PathLike

import numpy as np
from numpy.typing import ArrayLike

from ...errors import SceneError
from ..habits import warn
from .axes import check_place, radians, sky_axes, told, towards
from .epw import read_hour
from .perez import BRIGHTNESS, DEW_POINT, Weather
from .sky import Sky
from .sky_table import sky_of
from .sun import DIAMETER, Sun
from .sun_position import day_of_year


def perez_sky(
    direct: float,
    diffuse: float,
    *,
    sun: tuple[float, float],
    day: int = 172,
    dew_point: float = DEW_POINT,
    photometric: bool = True,
    ground: float = 0.0,
    diameter: float = DIAMETER,
    up: ArrayLike | str = "z",
    north: ArrayLike | None = None,
    name: str = "sky",
) -> tuple[Sky, tuple[Sun, ...]]:
    """Return the sky of Perez for all weathers, and its sun; no sun where its light is 0.

    Args:
        direct: normal irradiance by the sun, W/m².
        diffuse: horizontal irradiance by the sky, W/m².
        sun: altitude and azimuth of the sun, degrees, as of `sun_position`.
        day: of the year, 1 to 366 (the sun's distance depends on it by 3 %).
        dew_point: °C; how many lumens a watt has depends a little on it.
        photometric: lm/m², by the efficacies of the same authors. False: W/m².
        ground: share of what falls on the horizontal that the ground below the horizon reflects.
        diameter: degrees, of the sun's disc.
        up, north: where up and north are in the scene, see `sky_axes`.
        name: of the sky.

    Raises:
        SceneError: a value out of range, or a sky for which the formula gives no light.

    Example:
        >>> sky, suns = rd.perez_sky(600, 120, sun=(45, 180), photometric=False)
        >>> round(float(sky.horizontal[0]), 6), suns[0].irradiance.tolist()
        (120.0, [600.0])
    """
    for what, value in (("direct", direct), ("diffuse", diffuse)):
        if not (np.isfinite(value) and value >= 0):
            raise SceneError(f"sky '{name}': {what} irradiance must be 0 or more, W/m² (it is {value})")
    if not diffuse > 0:
        raise SceneError(f"sky '{name}': diffuse irradiance is {diffuse:g} W/m²; the sky of Perez needs some")
    if not 1 <= day <= 366:
        raise SceneError(f"sky '{name}': day is {day}; expected a day of the year, 1 to 366")
    altitude, azimuth = _raised(name, direct, *sun)
    axes = sky_axes(up, north)
    weather = Weather(direct, diffuse, radians((altitude, azimuth)), day, dew_point)
    if weather.brightness > BRIGHTNESS[1]:
        warn(
            f"sky '{name}': a diffuse irradiance of {diffuse:g} W/m² is more than any measured with the sun at "
            f"{altitude:.1f} degrees (brightness {weather.brightness:.2f}); its shape is that of {BRIGHTNESS[1]}; "
            "check the irradiance, the hour and the place"
        )
    of_direct, of_diffuse = weather.lumens if photometric else (1.0, 1.0)
    kind = f"Perez, clearness {weather.clearness:.2f}, brightness {weather.brightness:.3f}, {told((altitude, azimuth))}"
    suns = (
        (Sun("sun", towards(axes, altitude, azimuth), np.array([direct * of_direct]), diameter, photometric),)
        if direct * of_direct > 0 and altitude > 0
        else ()
    )
    return sky_of(name, weather.relative(), axes, diffuse * of_diffuse, ground, suns, kind, photometric), suns


def epw_sky(
    path: str | PathLike,
    month: int,
    day: int,
    hour: int,
    *,
    photometric: bool = True,
    ground: float = 0.0,
    diameter: float = DIAMETER,
    up: ArrayLike | str = "z",
    north: ArrayLike | None = None,
    name: str = "sky",
) -> tuple[Sky, tuple[Sun, ...]]:
    """Return the sky of Perez and the sun of an hour of a weather file of EnergyPlus (.epw).

    The sun stands where it is in the middle of that part of the hour in which it is up.

    Args:
        path: of the file.
        month, day, hour: as in the file: hour 12 is from 11 to 12 o'clock, standard time.
        photometric, ground, diameter, up, north, name: see `perez_sky`.

    Raises:
        SceneError: the file cannot be read, or has no light in this hour.

    Example:
        >>> import pathlib
        >>> place = "LOCATION,Town,-,DEU,made,0,52.5,13.4,1,35"
        >>> row = "2005,6,21,12,60,-,20,14,50,101000,0,0,300,673,600,150"
        >>> _ = pathlib.Path("town.epw").write_text(f"{place}\\n{row}\\n")
        >>> sky, suns = rd.epw_sky("town.epw", 6, 21, 12)
        >>> print(f"{sky.horizontal[0]:.0f} lx by the sky, {suns[0].irradiance[0]:.0f} lx across the sun's light")
        21482 lx by the sky, 60240 lx across the sun's light
    """
    found = read_hour(str(path), month, day, hour)
    where = f"{path}: month {month}, day {day}, hour {hour}"
    if not found.diffuse > 0:
        raise SceneError(f"{where}: the sky gives no light (diffuse horizontal irradiance is {found.diffuse:g}); is it night?")
    return perez_sky(
        found.direct,
        found.diffuse,
        sun=found.sun(),
        day=day_of_year(month, day),
        dew_point=DEW_POINT if found.dew_point is None else found.dew_point,
        photometric=photometric,
        ground=ground,
        diameter=diameter,
        up=up,
        north=north,
        name=name,
    )


def _raised(name: str, direct: float, altitude: float, azimuth: float) -> tuple[float, float]:
    """Return the sun's place, on the horizon where it is below it: the formula of Perez knows no other."""
    check_place(f"sky '{name}'", altitude, azimuth)
    if altitude > 0:
        return altitude, azimuth
    gone = f", and its {direct:g} W/m² are left out" if direct > 0 else ""
    warn(f"sky '{name}': the sun is {-altitude:.1f} degrees below the horizon; the sky is as if it stood on it{gone}")
    return 0.0, azimuth
