"""``radiosity annual``"""

from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Group, Parameter

from ..errors import MethodError, OutputError, printable
from . import interrupts, outputs
from .measure import cut_of
from .options import Count, Flag, Outputs, Point, Share
from .places import PointOptions, Points, sensors_of
from .solve import NOT_REACHED
from .solve_options import RUN, Replicated, SceneOptions, Size, Unset
from .streams import tell


@dataclass(frozen=True)
class Year:
    """The year.

    Attributes:
        epw: Weather file of EnergyPlus (.epw).
        sky_patches: Patches of the sky: 145 (Tregenza) or 577 (Reinhart).
        ground: Reflectance of what lies below the horizon; 0 where the scene has its own ground.
        north: Direction of north in the scene, as X,Y,Z. Default: that of its sky, or y where z is up and -z where y is up.
        occupied: Table of the hours that count, .csv: a number above 0 for each hour in which somebody is there. Default: 8 to 18
            o'clock on all days.
        hourly: Keep the lux of each hour of each sensor in the .npz output.
    """

    epw: Path
    sky_patches: Literal[145, 577] = 145
    ground: float = 0.2
    north: Point = None
    occupied: Path | None = None
    hourly: Flag = False


@dataclass(frozen=True)
class Tracing(Size):
    """How many lines, and patches.

    Attributes:
        rays: Number of lines in all, such as 2M.
        error: Trace until the relative error of the mean of each set of sensors is below this, such as 2% (the default); in 95 %
            of runs the true error then is. A run that ends above it has the exit status 3.
        patch_size: Longest edge of a patch, in metres. Default: about 2 000 patches in all.
        cells: Cut every face into CELLS x CELLS patches.
    """

    rays: Count = None
    error: Share = None


@dataclass(frozen=True)
class Running(Replicated):
    """What concerns the run.

    Attributes:
        cluster: Trace on the workers of Dask, as of `radiosity solve`: tcp://HOST:PORT, or local:N.
    """

    cluster: str | None = None


YearOptions = Annotated[Year, Parameter(name="*", group=Group("The year", sort_key=0))]
TracingOptions = Annotated[Tracing, Parameter(name="*", group=Group("Lines and patches", sort_key=2))]
RunningOptions = Annotated[Running, Parameter(name="*", group=RUN)]
NOWHERE, USUAL, PLAIN = Points(), Tracing(), Running()


def annual(
    scene: str,
    /,
    *,
    year: YearOptions,
    output: Outputs = (),
    points: PointOptions = NOWHERE,
    tracing: TracingOptions = USUAL,
    running: RunningOptions = PLAIN,
    reading: SceneOptions = Unset.reading,
) -> int:
    """Find the daylight of a year at sensors: DA, UDI, sDA, ASE.

    Skies of the weather file are those of Perez, and the sun stands where it is in each hour. The scene's own lights and sky do
    not count; its openings do: name them, or windows need many lines.

    Parameters
    ----------
    scene
        A scene file, a built-in scene, or an .npz file of `radiosity solve`, whose patches are taken.
    output
        Files to write: .csv (a row for each sensor), and .npz (all numbers).
    """
    from ..sensors.annual import outputs as of_years

    of_years.check(output)
    if year.hourly and not any(path.suffix.lower() == ".npz" for path in output):
        raise MethodError("--hourly keeps the lux of each hour in an .npz output: name one with -o")

    import radiosity as rd

    from .progress import bar

    options = asdict(tracing) | asdict(running) | asdict(year)
    cut = {"size": options.pop("patch_size"), "cells": options.pop("cells")}
    if options["rays"] is not None and options["error"] is not None:
        raise MethodError("give one of --rays and --error, not both")
    tables = [*points.points, *([] if year.occupied is None else [year.occupied])]
    outputs.spare(tables, output)
    loaded, scene_read = cut_of(scene, cut, reading, output)
    sensors = sensors_of(scene_read, points)
    north = options.pop("north")
    options["north"] = None if north is None else [float(value) for value in north.split(",")]
    with bar() as progress:
        found = rd.annual(loaded, options.pop("epw"), sensors, **options, progress=progress)
    tasks: list = [("the report", lambda: tell(found.report()))]
    failures = outputs.attempt([*tasks, *((path, partial(_write, found, path)) for path in output)])
    if failures:
        raise OutputError("; ".join(outputs.told(failures)))
    if found.status == "interrupted":
        return interrupts.status()
    return NOT_REACHED if found.status == "not reached" else 0


def _write(found, path: Path) -> None:
    found.save(path)
    tell(f"wrote {printable(path)}")
