"""`annual`, which finds the daylight of a year at sensors."""

from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...device import memory as memory_of
from ...device.turn import turn
from ...errors import MethodError, shown
from ...patches import Patches, subdivide
from ...run.budget import Budget
from ...run.on_cluster import on_cluster
from ...run.progress import Listener
from ...run.whole_number import whole
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
from ..groups import only
from ..measure import scene_of
from ..model import Sensors
from ..receivers import planes_of
from .memory import YearSizes
from .result import AnnualDaylight
from .schedule import read_schedule, usual
from .year_run import YearRun, hours_together, lines_of_each

ABOUT = 2000  # patches, where the scene is not cut yet: sensors see direct light by lines of their own
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
        return YearRun(*given).found(hourly)


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


def _refuse_large(sensors: Sensors, patches: Patches, sky: SkyPatches, replicates: int, budget: Budget, hours: int) -> None:
    n, many = len(sensors), len(patches)
    sizes = YearSizes(
        n,
        planes_of(sensors),
        many,
        patches.scene.n_faces,
        len(sky),
        replicates,
        lines_of_each(budget, n, many, replicates),
        (hours, hours_together(n, many)),
    )
    memory_of.refuse(
        sizes.whole(),
        f"the daylight coefficients of {n:,} sensors and {many:,} patches",
        "take fewer sensors or replicates, larger patches, or 145 sky patches",
    )
