"""What sensors measured."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from ..errors import MethodError
from ..problem.model import Problem
from ..scene.photopic import PHOTOPIC, RGB
from ..solution.model import Solution
from .groups import check_levels
from .model import Sensors
from .set_row import set_row
from .target import half_width


@dataclass(frozen=True, eq=False)
class Measurement:
    """Irradiance or illuminance at sensors.

    Attributes:
        sensors: where.
        values: (replicates, n_sensors, n_bands) float64, W/m² or lx.
        inside: (n_sensors,) bool, sensors that see mostly backs of surfaces: they seem to lie inside of something, and tables
            leave them out.
        bands: names of the bands.
        photometric: values are lx, not W/m².
        rays: lines of sensors, all replicates together.
        seconds: wall time, that of a solution made for it included.
        status: "complete", "interrupted" or "not reached".
        source: of the scene.
        parts: what each group of lights gives, as ``values``; empty where groups were not asked for.
        outside: what the sky gives a horizontal plane outside, all bands together, where it is the only light; else None.
        outsides: the same of each group that is the sky alone.

    Example:
        >>> patches = rd.subdivide(rd.load_scene("room"), cells=4)
        >>> desk = rd.Sensors.of([[1, 1, 0.8], [5, 1, 0.8]], name="desk")
        >>> found = rd.measure(patches, desk, rays=500_000)
        >>> low, high = found.interval()
        >>> bool((low < found.illuminance).all()), found.unit
        (True, 'W/m²')
    """

    sensors: Sensors
    values: np.ndarray
    inside: np.ndarray
    bands: tuple[str, ...]
    photometric: bool
    rays: int
    seconds: float
    status: str
    source: str
    parts: dict[str, np.ndarray] = field(default_factory=dict)
    outside: float | None = None
    outsides: dict[str, float] = field(default_factory=dict)

    @staticmethod
    def of(
        solution: Solution,
        sensors: Sensors,
        problem: Problem,
        shares: np.ndarray,
        inside: np.ndarray,
        rays: int,
        seconds: float,
        status: str,
    ) -> "Measurement":
        """Make it from (replicates, n_sensors, n_groups) shares of the unit of light."""
        scene, values = solution.patches.scene, in_bands(problem, shares)
        found = Measurement(sensors, values, inside, scene.bands, scene.photometric, rays, seconds, status, scene.source)
        sky = scene.lights.sky
        if sky is None or scene.lights.suns or scene.lights.luminaires or solution.patches.emission.any():
            return found
        outside = float(found._single(np.broadcast_to(sky.horizontal, (1, 1, len(scene.bands))))[0, 0])
        return replace(found, outside=outside if outside > 0 else None)

    @property
    def unit(self) -> str:
        """Unit of the values."""
        return "lx" if self.photometric else "W/m²"

    @cached_property
    def illuminance(self) -> np.ndarray:
        """The mean over replicates, (n_sensors, n_bands) float64, lx, or W/m² where the scene is not photometric."""
        return self.values.mean(axis=0)

    @property
    def irradiance(self) -> np.ndarray:
        """``illuminance`` by its other name."""
        return self.illuminance

    @cached_property
    def standard_error(self) -> np.ndarray:
        """The standard error of ``illuminance``, (n_sensors, n_bands); NaN (unknown) with one replicate."""
        count = len(self.values)
        if count < 2:
            return np.full(self.values.shape[1:], np.nan)
        return self.values.std(axis=0, ddof=1) / count**0.5

    def interval(self, level: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of Student's intervals, lower and upper, (n_sensors, n_bands) each; NaN with one replicate."""
        width = half_width(self.values, level)
        return np.maximum(self.illuminance - width, 0), self.illuminance + width

    def dimmed(self, levels: dict[str, float]) -> "Measurement":
        """Return what sensors get where groups of lights are dimmed, with errors, from `measure` with ``groups``.

        Args:
            levels: by names of groups: 0 is off, 1 as it was measured; groups that are left out stay at 1.

        Raises:
            MethodError: groups were not measured, there is no such group, or a level is negative or no number.

        Example:
            >>> room = rd.subdivide(rd.load_scene("room"), cells=4)
            >>> found = rd.measure(room, rd.Sensors.of([1, 1, 0.9]), groups=True, rays=500_000)
            >>> half = found.dimmed({"light": 0.5})
            >>> round(float(half.illuminance[0, 0] / found.illuminance[0, 0]), 6)
            0.5
        """
        if not self.parts:
            raise MethodError("groups of lights were not measured apart; call measure with groups=True")
        check_levels(levels, list(self.parts))
        parts = {name: values * levels.get(name, 1.0) for name, values in self.parts.items()}
        outsides = {name: value * levels.get(name, 1.0) for name, value in self.outsides.items()}
        shining = [name for name in parts if levels.get(name, 1.0) > 0]
        outside = outsides.get(shining[0]) if len(shining) == 1 else None
        values = np.sum(list(parts.values()), axis=0)
        return replace(self, values=values, parts=parts, outside=outside, outsides=outsides)

    @property
    def daylight_factor(self) -> np.ndarray:
        """What sensors get over what the sky gives a horizontal plane outside, (n_sensors,); of CIE's overcast sky it is the
        daylight factor.

        Raises:
            MethodError: there is other light than the sky's; measure with groups=True, and dim it to 0.
        """
        if self.outside is None:
            raise MethodError(
                "a daylight factor is of the sky's light alone; measure with groups=True, and dim all other groups to 0"
            )
        return self.single.mean(axis=0) / self.outside

    @cached_property
    def single(self) -> np.ndarray:
        """One value for all bands in each replicate, (replicates, n_sensors): red, green and blue by photopic weights, or the
        sum of other bands."""
        return self._single(self.values)

    def _single(self, values: np.ndarray) -> np.ndarray:
        if values.shape[2] == 1:
            return values[..., 0]
        return values @ PHOTOPIC if self.bands == RGB else values.sum(axis=2)

    @cached_property
    def single_parts(self) -> dict[str, np.ndarray]:
        """``parts`` as ``single`` is of ``values``, (replicates, n_sensors) each."""
        return {name: self._single(values) for name, values in self.parts.items()}

    def table(self, level: float = 0.95) -> list[dict]:
        """Return a row for each set of sensors: number, min, mean, max, U0 = min / mean, U1 = min / max, in ``unit``.

        It has half the width of the intervals of the mean, of U0 and of U1, too, and of the widest interval of a sensor. Those of
        U0 and U1 follow the sensors that have least and most in the mean. Where all sensors are dark U0 and U1 are NaN.
        """
        return [set_row(self, number, level) for number in range(len(self.sensors.names))]

    def report(self) -> str:
        """Return the table as text."""
        from .report import report

        return report(self)

    def save(self, path: str | Path) -> None:
        """Write a table of sensors (.csv), or isolines of grids (.png, .svg, .pdf), by the name's ending.

        Raises:
            OutputError: another ending, or a file that cannot be written.
        """
        from .outputs import write

        write(self, Path(path))


def in_bands(problem: Problem, shares: np.ndarray) -> np.ndarray:
    """Return irradiances, (..., n_bands), from shares of the unit of light, (..., n_groups)."""
    return (shares * problem.unit)[..., problem.groups.index] * problem.groups.scale
