"""The lines of a year, stage by stage, and the sum of its hours."""

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from ...device.backend import choose
from ...errors import MethodError
from ...patches import Patches
from ...problem.model import Problem
from ...run.budget import Budget
from ...run.progress import Listener, Stop, Teller
from ...sampling.streams import Seed
from ...scene.habits import warn
from ...scene.lights.sky_patches import SkyPatches
from ...scene.lights.weather_year import WeatherYear
from ...scene.lights.year_of_skies import YearOfSkies
from ...tracing.geometry import Geometry
from ..model import Sensors
from ..run import BEHIND
from ..target import worst
from .coefficients import Coefficients, Replicate, Setup
from .elsewhere import AbstractYearLines, tracing_on
from .figures import Figures
from .result import AnnualDaylight

FIRST, MOST = 256, 1 << 16  # lines of each kind of a sensor in the first stage, and at most, in each replicate


@dataclass(frozen=True, eq=False)
class YearRun:
    """Sensors in a prepared scene, the skies of a year, and a budget."""

    patches: Patches
    sensors: Sensors
    sky: SkyPatches
    axes: np.ndarray
    year: WeatherYear
    skies: YearOfSkies
    occupied: np.ndarray
    budget: Budget
    count: int
    seed: int
    device: str
    progress: Listener | None
    client: Any

    def found(self, hourly: bool) -> AnnualDaylight:
        """Trace lines until the budget is used up or Ctrl-C comes, and sum up the year; ``hourly`` keeps the lux of hours."""
        begun, stop, teller = perf_counter(), Stop(), Teller(self.budget, self.progress)
        geometry = Geometry(self.patches.solid, choose(self.device))
        _refuse_passing(geometry)
        problem = Problem.of(self.patches)
        teller.begin(0)
        setup = Setup(self.sensors, Seed(self.seed), self.sky, self.axes)
        with stop.listening(), tracing_on(self.client, setup, problem, geometry.device.name) as lines:
            runs = [setup.replicate(geometry, problem, number) for number in range(self.count)]
            coefficients, status = self._staged(runs, lines, teller, stop)
            inside = np.mean([run.behind() for run in runs], axis=0) > BEHIND
            self._tell_of_dark(coefficients, inside)
            mean, each, lux = self._summed(runs, lines, coefficients, teller, hourly)
        return AnnualDaylight(
            self.sensors,
            mean.values(),
            each.values(),
            inside,
            coefficients,
            self.sky,
            self.year,
            self.occupied,
            lux,
            teller.lines,
            perf_counter() - begun,
            status,
            self.patches.scene.source,
        )

    def _staged(self, runs: list[Replicate], lines: AbstractYearLines, teller: Teller, stop: Stop) -> tuple[Coefficients, str]:
        """Trace stage by stage; return the coefficients and a status."""
        known = lines_of_each(self.budget, len(self.sensors), len(self.patches), self.count)
        each = FIRST if known is None else known
        light = self.skies.with_suns(self.sky)[self.occupied[self.skies.hours]].sum(axis=0)
        while True:
            for more in lines.advance(runs, each):
                teller.lines += more
                teller.tell("tracing")
            pairs = [run.coefficients() for run in runs]
            found = Coefficients(*(np.stack(column) for column in zip(*pairs, strict=True)))
            if stop.asked:
                return found, "interrupted"
            if self.budget.error is None:
                return found, "complete"
            inside = np.mean([run.behind() for run in runs], axis=0) > BEHIND
            year = found.whole @ light
            now = worst(year[..., None], self.sensors, "mean", inside)
            teller.complete(teller.lines, each, now)
            if now <= self.budget.error:
                return found, "complete"
            if each >= MOST:
                warn(
                    f"the relative error of the mean of a set of sensors is {now:.2g}, and {self.budget.error:.2g} was asked for"
                )
                return found, "not reached"
            each *= 2

    def _tell_of_dark(self, coefficients: Coefficients, inside: np.ndarray) -> None:
        """Tell of sensors whose zero is unknown, since no line brought them light."""
        dark = int((~coefficients.whole.any(axis=(0, 2)) & ~inside).sum())
        if dark:
            source, many = self.patches.scene.source, f"{dark} of {len(self.sensors)} sensors"
            told = f"{source}: no line found the sky for {many}, straight or reflected"
            warn(f"{told}: their light is unknown and counts as 0; name the windows as openings, or take more lines")

    def _summed(self, runs: list[Replicate], lines: AbstractYearLines, coefficients: Coefficients, teller: Teller, hourly: bool):
        """Return the figures of means over replicates, those of each replicate, and the lux of hours where they are kept."""
        n, skies = len(self.sensors), self.skies
        mean, each = Figures.nothing(n), Figures.nothing(self.count, n)
        lux = np.zeros((n, len(self.year)), np.float32) if hourly else None
        occupied = self.occupied[skies.hours]
        step = hours_together(n, len(self.patches))
        whole = coefficients.whole
        for at in range(0, len(skies.hours), step):
            rows = slice(at, at + step)
            here = whole @ skies.radiance[rows].T
            by_sun = np.zeros_like(here)
            lit = np.flatnonzero(skies.direct[rows] > 0)
            shares = lines.suns(runs, skies.towards[rows][lit], at) if len(lit) else []
            for replicate, (straight, reflected) in enumerate(shares):
                by_sun[replicate][:, lit] = straight * skies.direct[rows][lit]
                here[replicate][:, lit] += (straight + reflected) * skies.direct[rows][lit]
            mean.add(here.mean(axis=0), by_sun.mean(axis=0), occupied[rows])
            each.add(here, by_sun, occupied[rows])
            if lux is not None:
                lux[:, skies.hours[rows]] = here.mean(axis=0)
            teller.tell("the year's hours")
        for figures in (mean, each):
            figures.dark(int(self.occupied.sum() - occupied.sum()))
        return mean, each, lux


def _refuse_passing(geometry: Geometry) -> None:
    if geometry.some_backs_pass:
        raise MethodError(
            f"{geometry.scene.source}: some backs let lines pass, so that a line sees several surfaces; a year counts one: "
            "make these surfaces radiate or absorb on both sides"
        )


def lines_of_each(budget: Budget, sensors: int, patches: int, replicates: int) -> int | None:
    """Return the lines of each kind of a sensor in a replicate; None where they follow from an error."""
    return None if budget.rays is None else max(int(budget.rays / (2 * (sensors + patches / 4) * replicates)), 2)


def hours_together(sensors: int, patches: int) -> int:
    """Return how many hours are summed up together."""
    return max(min((1 << 23) // max(patches, sensors), 1 << 9), 1)
