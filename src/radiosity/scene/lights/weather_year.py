"""The weather of a year, hour by hour, from a weather file of EnergyPlus (.epw)."""

from dataclasses import dataclass
from functools import cached_property
from os import PathLike

import numpy as np

from ...errors import SceneError
from ..habits import warn
from .epw import DEW_POINT, DIFFUSE, DIRECT, GLOBAL, MISSING, apart, lines_of, values_of
from .perez import DEW_POINT as USUAL_DEW_POINT
from .sun_position import YEAR, day_of_year, days_after_2000, sun_positions

HOURS, LEAP = (8760, 8784), 2024  # of a year, and of a leap year
MINUTES = 60  # times of an hour at which it is asked whether the sun is up


@dataclass(frozen=True, eq=False)
class WeatherYear:
    """The weather of a year: hour h of a day is from h - 1 to h o'clock, standard time.

    Attributes:
        place: the city.
        latitude, longitude: degrees, north and east are positive.
        timezone: hours ahead of UTC.
        date: (n, 3) int64, month, day, and hour from 1 to 24, in the order of the year.
        direct: (n,) float64, mean direct normal irradiance of each hour, W/m².
        diffuse: (n,) mean diffuse horizontal irradiance, W/m².
        dew_point: (n,) °C.
        source: the file.
    """

    place: str
    latitude: float
    longitude: float
    timezone: float
    date: np.ndarray
    direct: np.ndarray
    diffuse: np.ndarray
    dew_point: np.ndarray
    source: str

    def __len__(self) -> int:
        return len(self.date)

    @cached_property
    def day(self) -> np.ndarray:
        """The day of the year of each hour, from 1 on, (n,) int64."""
        return np.array([day_of_year(month, day, self._year) for month, day in self.date[::24, :2].tolist()]).repeat(24)

    @property
    def _year(self) -> int:
        """A year with as many days."""
        return LEAP if len(self) == HOURS[1] else YEAR

    @cached_property
    def sun(self) -> tuple[np.ndarray, np.ndarray]:
        """The sun's altitude and azimuth, degrees, (n,) each, in the middle of that part of each hour in which it is up."""
        midnight = days_after_2000(self._year, 1, 1) + self.day - 1
        begin = midnight + (self.date[:, 2] - 1 - self.timezone) / 24
        times = begin[:, None] + (np.arange(MINUTES) + 0.5) / MINUTES / 24
        up = sun_positions(self.latitude, self.longitude, times)[0] > 0
        count = up.sum(axis=1)
        middle = np.where(count > 0, (times * up).sum(axis=1) / np.maximum(count, 1), begin + 0.5 / 24)
        return sun_positions(self.latitude, self.longitude, middle)


def read_year(path: str | PathLike) -> WeatherYear:
    """Read the weather of a year.

    Raises:
        SceneError: the file cannot be read, has not each hour of a year once and in order, or a value is missing or no number.
    """
    lines, place = lines_of(str(path))
    dates, values = [], []
    for number, line in enumerate(lines[1:], 2):
        row = line.split(",")
        if len(row) < 4 or not row[0].strip().isdecimal():
            continue  # a line of the head
        found = values_of(str(path), number, row)
        try:
            date = [int(cell) for cell in row[1:4]]
        except ValueError:
            raise SceneError(f"{path}: line {number}: month, day and hour must be whole numbers (they are {row[1:4]})") from None
        if date[2] != len(dates) % 24 + 1:
            raise SceneError(
                f"{path}: line {number}: hour is {date[2]}, and {len(dates) % 24 + 1} was expected; a year needs each hour once, "
                "1 to 24, in the order of the days"
            )
        dates.append(date)
        values.append([found[DIRECT], found[DIFFUSE], found[DEW_POINT], found[GLOBAL]])
    if len(dates) not in HOURS:
        raise SceneError(f"{path}: has {len(dates)} hours; a year has {HOURS[0]}, or {HOURS[1]} with the 29th of February")
    date = np.array(dates)
    direct, diffuse, dew_point, measured = np.array(values).T
    dew_point = np.where(dew_point < MISSING[DEW_POINT], dew_point, USUAL_DEW_POINT)
    year = WeatherYear(*place, date, direct, diffuse, dew_point, str(path))
    if (np.diff(year.day[::24]) != 1).any() or year.day[0] != 1:
        late = int(np.argmax(np.append(np.diff(year.day[::24]) != 1, True))) + 1
        month, day = date[24 * min(late, len(date) // 24 - 1), :2].tolist()
        raise SceneError(f"{path}: the days are not in order at month {month}, day {day}; a year goes from January to December")
    _compare(year, measured)
    return year


def _compare(year: WeatherYear, measured: np.ndarray) -> None:
    """Warn where global horizontal irradiances, (n,) W/m², are others than their parts make at the sun's altitude."""
    summed = year.diffuse + year.direct * np.sin(np.radians(np.maximum(year.sun[0], 0)))
    wrong = np.flatnonzero(apart(measured, summed))
    if len(wrong):
        worst = wrong[np.argmax(np.abs(measured - summed)[wrong])]
        month, day, hour = year.date[worst].tolist()
        when = f"month {month}, day {day}, hour {hour}: {measured[worst]:g} and {summed[worst]:.0f} W/m²"
        warn(
            f"{year.source}: in {len(wrong)} hours global horizontal irradiance is another one than direct normal and diffuse "
            f"make at the sun's altitude ({when}); check the time zone and the file (direct and diffuse are taken)"
        )
