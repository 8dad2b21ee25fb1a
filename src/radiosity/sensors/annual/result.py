"""What `annual` found."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...scene.lights.sky_patches import SkyPatches
from ...scene.lights.weather_year import WeatherYear
from ..model import Sensors
from ..target import half_width
from .coefficients import Coefficients
from .figures import of_set


@dataclass(frozen=True, eq=False)
class AnnualDaylight:
    """The daylight of a year at sensors.

    Attributes:
        sensors: where.
        values: figures of the lux of the mean over replicates, (n_sensors,) float64 each. "DA", "cDA", "UDI below",
            "UDI supplementary", "UDI autonomous" and "UDI above" are shares of occupied hours; "sun hours" are occupied hours
            with 1000 lx or more straight from the sun; "mean" is the mean of occupied hours, lx.
        replicates: the same of each replicate, (replicates, n_sensors) each.
        inside: (n_sensors,) bool, sensors that see mostly backs of surfaces; tables leave them out.
        coefficients: of daylight.
        sky: the subdivision of the sky that they are for.
        weather: the year.
        occupied: (n_hours,) bool, the hours that count.
        hourly: (n_sensors, n_hours) float32, lx; None where it was not asked for.
        rays: lines in all; those to the sun of each hour are not among them.
        seconds: wall time.
        status: "complete", "interrupted" or "not reached".
        source: of the scene.

    Example:
        >>> from datetime import date, timedelta
        >>> from pathlib import Path
        >>> days = [date(2025, 1, 1) + timedelta(number) for number in range(365)]
        >>> light = {11: "500,120", 12: "600,150"}  # direct and diffuse, W/m²
        >>> row = "2005,{0.month},{0.day},{1},60,-,20,14,50,101000,0,0,300,9999,{2}"
        >>> rows = [row.format(day, hour, light.get(hour, "0,0")) for day in days for hour in range(1, 25)]
        >>> _ = Path("town.epw").write_text("\\n".join(["LOCATION,Town,-,DEU,made,0,52.5,13.4,1,35", *rows]))
        >>> roof = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.5, 0.0)
        >>> found = rd.annual(rd.subdivide(roof, cells=1), "town.epw", rd.Sensors.of([0.3, 0.3, 0.1]), rays=10_000)
        >>> found.coefficients.straight.shape, round(float(found.coefficients.whole[0].sum()), 1)
        ((8, 1, 146), 3.1)
    """

    sensors: Sensors
    values: dict[str, np.ndarray]
    replicates: dict[str, np.ndarray]
    inside: np.ndarray
    coefficients: Coefficients
    sky: SkyPatches
    weather: WeatherYear
    occupied: np.ndarray
    hourly: np.ndarray | None
    rays: int
    seconds: float
    status: str
    source: str

    def half_widths(self, level: float = 0.95) -> dict[str, np.ndarray]:
        """Return half the width of Student's interval of each figure of ``values``, (n_sensors,) each."""
        return {name: half_width(values, level) for name, values in self.replicates.items()}

    def table(self, level: float = 0.95) -> list[dict]:
        """Return a row for each set of sensors: means of the figures of its sensors, and sDA and ASE as shares of sensors.

        sDA is the share with 300 lx in half of the occupied hours or more, ASE that with more than 250 occupied hours of 1000 lx
        straight from the sun. Each figure has half the width of its interval beside it, as "DA ±".
        """
        rows = []
        for number, name in enumerate(self.sensors.names):
            chosen = (self.sensors.set == number) & ~self.inside
            row: dict = {"name": name, "sensors": int(chosen.sum())}
            if chosen.any():
                found, each = (
                    of_set({key: column[..., chosen] for key, column in columns.items()})
                    for columns in (self.values, self.replicates)
                )
                for key, value in found.items():
                    row |= {key: float(value), f"{key} ±": float(half_width(each[key], level))}
            rows.append(row)
        return rows

    def report(self) -> str:
        """Return the table as text."""
        from .outputs import report

        return report(self)

    def save(self, path: str | Path) -> None:
        """Write a table of sensors (.csv), or all numbers (.npz), by the name's ending.

        Raises:
            OutputError: another ending, or a file that cannot be written.
        """
        from .outputs import write

        write(self, Path(path))
