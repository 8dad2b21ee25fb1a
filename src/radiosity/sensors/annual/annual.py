"""`annual`, which finds the daylight of a year at sensors."""

from dataclasses import dataclass, replace
from os import PathLike
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...device import memory as memory_of
from ...device.backend import choose
from ...device.turn import turn
from ...errors import MethodError, shown
from ...patches import Patches, subdivide
from ...problem.model import Problem
from ...run.budget import Budget
from ...run.on_cluster import on_cluster
from ...run.progress import Listener, Stop, Teller
from ...run.whole_number import whole
from ...sampling.streams import Seed
from ...scene.habits import warn
from ...scene.lights.axes import sky_axes
from ...scene.lights.model import Lights
from ...scene.lights.skies import uniform_sky
from ...scene.lights.sky_patches import SkyPatches
from ...scene.lights.weather_year import WeatherYear, read_year
from ...scene.lights.year_of_skies import YearOfSkies
from ...scene.model import Scene
from ...scene.photopic import RGB
from ...scene.up import up_vector
from ...solution.model import Solution
from ...tracing.geometry import Geometry
from ..groups import only
from ..measure import scene_of
from ..model import Sensors
from ..receivers import planes_of
from ..run import BEHIND
from ..target import worst
from .coefficients import Coefficients, Replicate, Setup
from .elsewhere import AbstractYearLines, tracing_on
from .figures import Figures
from .memory import YearSizes
from .result import AnnualDaylight
from .schedule import read_schedule, usual

ABOUT = 2000  # patches, where the scene is not cut yet: sensors see direct light by lines of their own
FIRST, MOST = 256, 1 << 16  # lines of each kind of a sensor in the first stage, and at most, in each replicate
REPLICATES = 8
GROUND = 0.2


def annual(
    scene: Scene | Patches | Solution,
    weather: str | PathLike | WeatherYear,
    sensors: Sensors | None = None,
    *,
    sky_patches: int = 145,
    ground: float = GROUND,
    up: ArrayLike | str | None = None,
    north: ArrayLike | None = None,
    occupied: str | PathLike | ArrayLike | None = None,
    hourly: bool = False,
    rays: float | None = None,
    error: float | None = None,
    replicates: int = REPLICATES,
    seed: int = 0,
    device: str = "auto",
    progress: Listener | None = None,
    memory: str | float | None = None,
    cluster: Any = None,
) -> AnnualDaylight:
    """Find the daylight that sensors get in each hour of a year, and its figures: DA, UDI, sDA, ASE.

    Lines find what each sensor gets from each sky patch of radiance 1, straight and by all reflections. An hour is then a sum
    over the skies of Perez. The sun is no patch: in each hour rays go from sensors and patches to its disc, where it stands. The
    scene's own lights and its sky do not count.

    Args:
        scene: a `Scene`, or patches, or a solution, whose patches are taken. A scene is cut into about 2000 patches.
        weather: a weather file of EnergyPlus (.epw).
        sensors: where; by default what the scene's file asks for.
        sky_patches: 145 (Tregenza) or 577 (Reinhart).
        ground: reflectance of what lies below the horizon; 0 where the scene has its own ground.
        up, north: where they are in the scene, see `uniform_sky`; by default as of its sky, or the axis that seems to be up.
        occupied: the hours that count, (8760,) numbers above 0, or a table (.csv); by default 8 to 18 o'clock on all days.
        hourly: the result keeps the lux of each hour.
        rays, error: one at most: lines in all; or the relative error that the mean of each set is below in 95 % of runs, of
            the light of the year. The default is an error of 2 %.
        replicates: independent randomised runs, 2 or more.
        seed: with the same inputs, the same bits.
        device, progress, memory, cluster: as of `solve`.

    Returns:
        The figures of each sensor and of each set, with errors. Ctrl-C ends the lines early; the year is summed up all the same.

    Raises:
        SceneError: the weather, the schedule or a value makes no sense. MethodError: a choice makes no sense, backs let lines
            pass, or bands are not red, green and blue.

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
        >>> found.values["DA"].round(3).tolist(), found.table()[0]["sDA"]
        ([0.2], 0.0)
    """
    given = scene_of(scene, "annual")
    if sensors is None:
        sensors = Sensors.of_scene(given)
    if not isinstance(sensors, Sensors):
        raise MethodError(f"annual takes Sensors, not {type(sensors).__name__}; make them with Sensors.of or Sensors.grid")
    if rays is not None and error is not None:
        raise MethodError("give rays or an error, not both")
    budget = Budget(rays=rays, error=0.02 if rays is None and error is None else error)
    count, number = whole(replicates, "replicates", 2), whole(seed, "seed", 0)
    if len(given.bands) > 1 and tuple(given.bands) != RGB:
        raise MethodError(f"{given.source}: lux need one band, or red, green and blue, not {', '.join(given.bands)}")
    sky = SkyPatches.of(sky_patches)
    year = weather if isinstance(weather, WeatherYear) else read_year(weather)
    there = _occupied(occupied, year)
    axes = _axes(given, up, north)
    skies = YearOfSkies.of(year, sky, axes, ground)
    _tell_of_lights(given)
    with memory_of.limited(memory), turn(), on_cluster(cluster) as client:
        patches = _prepared(scene, axes)
        _refuse_large(sensors, patches, sky, count, budget, len(year) if hourly else 0)
        given = patches, sensors, sky, axes, year, skies, there, budget, count, number, device, progress, client
        return _Run(*given).found(hourly)


@dataclass(frozen=True, eq=False)
class _Run:
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

    def _staged(
        self, runs: list[Replicate], lines: AbstractYearLines, teller: Teller, stop: Stop
    ) -> tuple[Coefficients, str]:
        """Trace stage by stage; return the coefficients and a status."""
        known = _lines_of_each(self.budget, len(self.sensors), len(self.patches), self.count)
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
        step = _hours_together(n, len(self.patches))
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


def _prepared(scene: Scene | Patches | Solution, axes: np.ndarray) -> Patches:
    """Return the patches of a scene whose only light is a sky, and ground, of radiance 1."""
    given = scene.patches if isinstance(scene, Solution) else scene
    alone = only(given, scene_of(scene), [], [False] * len(scene_of(scene).lights.all))
    patches = subdivide(alone, about=ABOUT) if isinstance(alone, Scene) else alone
    lights = Lights(sky=replace(uniform_sky(np.pi, ground=1.0), axes=axes), openings=patches.scene.lights.openings)
    return replace(patches, scene=replace(patches.scene, lights=lights, photometric=True))


def _axes(scene: Scene, up, north) -> np.ndarray:
    """Return the directions of north, east and up: as given, or those of the scene's sky, or what seems to be up."""
    sky = scene.lights.sky
    if up is None and north is None and sky is not None:
        return sky.axes
    seems = "y" if up_vector(scene)[1] else "z"
    return sky_axes(seems if up is None else up, north)


def _occupied(given, year: WeatherYear) -> np.ndarray:
    if given is None:
        return usual(year.date)
    if isinstance(given, str | PathLike):
        return read_schedule(str(given), year.date)
    values = np.asarray(given)
    if values.shape != (len(year),) or not (values > 0).any():
        raise MethodError(
            f"occupied has the shape {values.shape}; give ({len(year)},) numbers, one above 0 where somebody is there"
        )
    return values > 0


def _tell_of_lights(scene: Scene) -> None:
    """Tell which lights of the scene do not count."""
    lit = [scene.names[i] for i in np.unique(scene.surface[(scene.emission > 0).any(axis=1)])]
    if names := [*(one.name for one in scene.lights.all), *lit]:
        told = "annual daylight is of the weather's skies and suns; the scene's own light is left out"
        warn(f"{scene.source}: {told}: {shown(names)}")


def _refuse_passing(geometry: Geometry) -> None:
    if geometry.some_backs_pass:
        raise MethodError(
            f"{geometry.scene.source}: some backs let lines pass, so that a line sees several surfaces; a year counts one: "
            "make these surfaces radiate or absorb on both sides"
        )


def _lines_of_each(budget: Budget, sensors: int, patches: int, replicates: int) -> int | None:
    """Return the lines of each kind of a sensor in a replicate; None where they follow from an error."""
    return None if budget.rays is None else max(int(budget.rays / (2 * (sensors + patches / 4) * replicates)), 2)


def _hours_together(sensors: int, patches: int) -> int:
    """Return how many hours are summed up together."""
    return max(min((1 << 23) // max(patches, sensors), 1 << 9), 1)


def _refuse_large(sensors: Sensors, patches: Patches, sky: SkyPatches, replicates: int, budget: Budget, hours: int) -> None:
    n, many = len(sensors), len(patches)
    sizes = YearSizes(
        n,
        planes_of(sensors),
        many,
        patches.scene.n_faces,
        len(sky),
        replicates,
        _lines_of_each(budget, n, many, replicates),
        (hours, _hours_together(n, many)),
    )
    memory_of.refuse(
        sizes.whole(),
        f"the daylight coefficients of {n:,} sensors and {many:,} patches",
        "take fewer sensors or replicates, larger patches, or 145 sky patches",
    )
