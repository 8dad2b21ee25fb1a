"""The place of the sun.

The Astronomical Almanac's approximate formula, as J. Michalsky gives it: "The Astronomical Almanac's algorithm for approximate
solar position (1950-2050)", Solar Energy 40(3), 1988, 227-235, with its erratum. It errs by 0.01 degrees. Refraction is added, as
there: the sun stands where its light comes from.
"""

from datetime import date
from typing import Any

import numpy as np

from ...errors import SceneError

YEARS = (1950, 2050)
YEAR = 2025  # where none is given; other years differ by up to 0.2 degrees


def sun_position(
    latitude: float, longitude: float, timezone: float, month: int, day: int, hour: float, year: int = YEAR
) -> tuple[float, float]:
    """Return the altitude of the sun above the horizon, and its azimuth from north through east, degrees.

    Args:
        latitude: degrees, north is positive.
        longitude: degrees, east is positive.
        timezone: hours that standard time is ahead of UTC (Berlin 1, New York -5). Daylight saving time is not added.
        month, day: 1 to 12, and of the month.
        hour: of standard time, 0 to 24, such as 14.5.
        year: 1950 to 2050.

    Raises:
        SceneError: a value out of range.

    Example:
        >>> altitude, azimuth = rd.sun_position(52.5, 13.4, 1, 6, 21, 12.1)
        >>> round(altitude), round(azimuth)
        (61, 179)
    """
    for name, value, low, high in (
        ("latitude", latitude, -90, 90),
        ("longitude", longitude, -180, 180),
        ("timezone", timezone, -14, 14),
        ("hour", hour, 0, 24),
        ("year", year, *YEARS),
    ):
        if not low <= value <= high:
            raise SceneError(f"{name}: it is {value}; expected {low} to {high}")
    altitude, azimuth = sun_positions(latitude, longitude, days_after_2000(year, month, day) + (hour - timezone) / 24)
    return float(altitude), float(azimuth)


def sun_positions(latitude: float, longitude: float, time: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return altitudes and azimuths, degrees, as `sun_position` does, at times in days after noon of 2000-01-01, UTC."""
    right_ascension, declination, sidereal = _place(time)
    turn, north = np.radians(sidereal + longitude) - right_ascension, np.radians(latitude)
    height = np.sin(declination) * np.sin(north) + np.cos(declination) * np.cos(north) * np.cos(turn)
    level = np.sin(declination) * np.cos(north) - np.cos(declination) * np.sin(north) * np.cos(turn)
    altitude = np.degrees(np.arcsin(np.clip(height, -1, 1)))
    azimuth = np.degrees(np.arctan2(-np.cos(declination) * np.sin(turn), level)) % 360
    return altitude + _refraction(altitude), azimuth


def day_of_year(month: int, day: int, year: int = YEAR) -> int:
    """Return the number of a day, 1 to 366.

    Raises:
        SceneError: there is no such day.
    """
    try:
        return date(year, month, day).timetuple().tm_yday
    except (ValueError, TypeError):
        if (month, day) == (2, 29):  # of a year that is not given
            return 60
        raise SceneError(f"month, day: there is no day {day} in month {month}") from None


def days_after_2000(year: int, month: int, day: int) -> float:
    """Return the days from noon of the first of January 2000 to the beginning of a day."""
    return (date(year, 1, 1) - date(2000, 1, 1)).days + day_of_year(month, day, year) - 1.5


def _place(time: Any) -> tuple[Any, Any, Any]:
    """Return the sun's right ascension and declination, rad, and Greenwich's sidereal time, degrees.

    Args:
        time: days after noon of 2000-01-01, UTC.
    """
    anomaly = np.radians(357.528 + 0.9856003 * time)
    longitude = np.radians(280.460 + 0.9856474 * time + 1.915 * np.sin(anomaly) + 0.020 * np.sin(2 * anomaly))
    obliquity = np.radians(23.439 - 0.0000004 * time)
    right_ascension = np.arctan2(np.cos(obliquity) * np.sin(longitude), np.cos(longitude))
    declination = np.arcsin(np.sin(obliquity) * np.sin(longitude))
    hours = (time + 0.5) % 1 * 24
    return right_ascension, declination, (6.697375 + 0.0657098242 * time + hours) * 15 % 360


def _refraction(altitude: np.ndarray) -> np.ndarray:
    """Return by how much air lifts the sun, degrees, from its true altitude."""
    seen = np.maximum(altitude, -0.56)
    top = 0.1594 + 0.0196 * seen + 0.00002 * seen**2
    return np.where(altitude <= -0.56, 0.56, 3.51561 * top / (1 + 0.505 * seen + 0.0845 * seen**2))
