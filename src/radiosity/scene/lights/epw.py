"""An hour of a weather file of EnergyPlus (.epw)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import SceneError, shown
from ..habits import warn
from .sun_position import sun_position

# columns of a row: see "EnergyPlus Weather File (EPW) Data Dictionary", Auxiliary Programs
DEW_POINT, GLOBAL, DIRECT, DIFFUSE = 7, 13, 14, 15
MISSING = {DEW_POINT: 99.9, GLOBAL: 9999.0, DIRECT: 9999.0, DIFFUSE: 9999.0}  # from these values on there is no measurement
NAMES = {DEW_POINT: "dew point", GLOBAL: "global horizontal", DIRECT: "direct normal", DIFFUSE: "diffuse horizontal"}
APART, LEAST = 0.25, 50.0  # share and W/m²: a global irradiance that differs by more from the sum of its parts is told


@dataclass(frozen=True)
class EpwHour:
    """What a weather file says of an hour.

    Attributes:
        place: the city.
        latitude, longitude: degrees, north and east are positive.
        timezone: hours ahead of UTC.
        month, day, hour: the hour ends at this number, 1 to 24, of standard time.
        direct: mean direct normal irradiance, W/m².
        diffuse: mean diffuse horizontal irradiance, W/m².
        dew_point: °C; None where it is missing.
    """

    place: str
    latitude: float
    longitude: float
    timezone: float
    month: int
    day: int
    hour: int
    direct: float
    diffuse: float
    dew_point: float | None

    def sun(self) -> tuple[float, float]:
        """Return the sun's altitude and azimuth, degrees, in the middle of that part of the hour in which it is up."""

        def at(time: float) -> tuple[float, float]:
            return sun_position(self.latitude, self.longitude, self.timezone, self.month, self.day, time)

        times = self.hour - 1 + (np.arange(60) + 0.5) / 60
        up = [time for time in times if at(time)[0] > 0]
        return at(float(np.mean(up)) if up else self.hour - 0.5)


def read_hour(path: str | Path, month: int, day: int, hour: int) -> EpwHour:
    """Read an hour of a weather file.

    Args:
        hour: 1 to 24, as in the file: hour 12 is from 11 to 12 o'clock, standard time.

    Raises:
        SceneError: no such file or hour, or a value that is missing or no number.
    """
    lines, (place, latitude, longitude, timezone) = lines_of(path)
    number, row = _row(path, lines, month, day, hour)
    values = values_of(path, number, row)
    known = values[DEW_POINT] < MISSING[DEW_POINT]
    found = EpwHour(
        place,
        latitude,
        longitude,
        timezone,
        month,
        day,
        hour,
        values[DIRECT],
        values[DIFFUSE],
        values[DEW_POINT] if known else None,
    )
    _compare(path, number, found, values[GLOBAL])
    return found


def lines_of(path: str | Path) -> tuple[list[str], tuple[str, float, float, float]]:
    """Return the lines of a weather file, and the city, its latitude and longitude, and the time zone.

    Raises:
        SceneError: the file cannot be read, or is none.
    """
    try:
        lines = Path(path).read_text(encoding="latin-1").splitlines()
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from None
    first = lines[0].split(",") if lines else []
    if len(first) < 10 or first[0].strip().upper() != "LOCATION":
        raise SceneError(f"{path}: is no weather file (.epw): its first line does not begin with LOCATION, or is cut short")
    latitude, longitude, timezone = (
        _number(path, 1, what, first[at]) for at, what in ((6, "latitude"), (7, "longitude"), (8, "time zone"))
    )
    return lines, (first[1].strip(), latitude, longitude, timezone)


def values_of(path: str | Path, number: int, row: list[str]) -> dict[int, float]:
    """Return the values of a row by the numbers of their columns.

    Raises:
        SceneError: the row is cut short, or a direct or diffuse irradiance is missing or no number.
    """
    if len(row) <= DIFFUSE:
        raise SceneError(f"{path}: line {number} is cut short; it has {len(row)} columns of 35")
    values = {column: _number(path, number, NAMES[column], row[column]) for column in MISSING}
    for column in (DIRECT, DIFFUSE):
        if values[column] >= MISSING[column] or values[column] < 0:
            raise SceneError(f"{path}: line {number}: {NAMES[column]} irradiance is missing (it is {values[column]:g})")
    return values


def _row(path: str | Path, lines: list[str], month: int, day: int, hour: int) -> tuple[int, list[str]]:
    """Return the line of an hour and its cells; the first one where several years have it, which is told."""
    found, rows = [], [(number, line.split(",")) for number, line in enumerate(lines[1:], 2)]
    for number, row in rows:
        date = _whole(row[1:4])
        if date is not None and len(date) == 3 and row[0].strip().isdecimal() and not 1 <= date[2] <= 24:
            raise SceneError(
                f"{path}: line {number}: hour is {date[2]}; hours of a weather file are 1 to 24, and end at that number"
            )
        if date == [month, day, hour]:
            found.append((number, row))
    where = f"month {month}, day {day}, hour {hour}"
    if not found:
        raise SceneError(f"{path}: has no row for {where}; hours are 1 to 24, and end at that number")
    if len(found) > 1:
        numbers, years = [number for number, _ in found], [row[0].strip() for _, row in found]
        what = f"{path}: has {len(found)} rows for {where}, in lines {shown(numbers, 4)}"
        if len(set(years)) < len(years):
            raise SceneError(f"{what}; several rows an hour are not read: keep one for each hour, of its means")
        warn(f"{what}, of the years {shown(years, 4)}; the first is taken")
    return found[0]


def _compare(path: str | Path, number: int, hour: EpwHour, measured: float) -> None:
    """Warn where the global irradiance is another one than its parts make."""
    summed = hour.diffuse + hour.direct * max(np.sin(np.radians(hour.sun()[0])), 0)
    if apart(measured, summed):
        warn(
            f"{path}: line {number}: global horizontal irradiance is {measured:g} W/m², but direct normal and diffuse make "
            f"{summed:.0f} W/m² at the sun's altitude; check the time zone and the file (direct and diffuse are taken)"
        )


def apart(measured, summed):
    """Return where measured global irradiances, W/m², are others than the sums of their parts."""
    return (measured < MISSING[GLOBAL]) & (np.abs(measured - summed) > np.maximum(APART * measured, LEAST))


def _whole(cells: list[str]) -> list[int] | None:
    try:
        return [int(cell) for cell in cells]
    except ValueError:
        return None


def _number(path: str | Path, line: int, what: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise SceneError(f"{path}: line {line}: {what} is no number (it is '{text.strip()}')")
    return value
