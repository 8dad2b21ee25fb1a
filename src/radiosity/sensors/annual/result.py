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

    Example: see `radiosity.annual`.
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
