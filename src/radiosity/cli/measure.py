"""``radiosity measure``"""

from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Group, Parameter

from ..errors import MethodError, OutputError, printable
from . import interrupts, outputs
from .exchange import named_numbers
from .options import Count, Flag, Length, Outputs, Share
from .places import NOWHERE, PlaceOptions, observer_of, sensors_of
from .solve import NOT_REACHED
from .solve_options import RUN, Machine, SceneOptions, Unset
from .streams import tell


@dataclass(frozen=True)
class Tracing:
    """How many lines, and patches.

    Attributes:
        rays: Number of lines in all, such as 2M.
        error: Trace until the relative error is below this, such as 1% (the default); in 95 % of runs the true error then is. A
            run that ends above it has the exit status 3.
        error_of: What --error is the error of: the mean of each set of sensors, or the worst sensor.
        importance: Share out the lines of the solution by what they add at the sensors: for sensors far from all lamps
            (docs/importance.md).
        patch_size: Longest edge of a patch, in metres. Default: about 20 000 patches in all.
        cells: Cut every face into CELLS x CELLS patches.
    """

    rays: Count = None
    error: Share = None
    error_of: Literal["mean", "worst"] = "mean"
    importance: Flag = False
    patch_size: Length = None
    cells: Count = None


@dataclass(frozen=True)
class Running(Machine):
    """What concerns the run.

    Attributes:
        replicates: Number of independent randomised runs, from which errors are found. Default: 8, or those of the solution.
        cluster: Trace on the workers of Dask, as of `radiosity solve`: tcp://HOST:PORT, or local:N.
    """

    replicates: Count = None
    cluster: str | None = None


TracingOptions = Annotated[Tracing, Parameter(name="*", group=Group("Lines and patches", sort_key=2))]
RunningOptions = Annotated[Running, Parameter(name="*", group=RUN)]
USUAL, PLAIN = Tracing(), Running()


def measure(
    scene: str,
    /,
    *,
    output: Outputs = (),
    places: PlaceOptions = NOWHERE,
    tracing: TracingOptions = USUAL,
    running: RunningOptions = PLAIN,
    reading: SceneOptions = Unset.reading,
) -> int:
    """Measure lux, or W/m2, at sensors: grids above a floor, or points.

    Each sensor is measured by lines of its own, so that shadows are sharp. The table has the least, mean and largest value of
    each set of sensors, and its uniformity U0 = min / mean and U1 = min / max.

    Parameters
    ----------
    scene
        A scene file, a built-in scene, or an .npz file of `radiosity solve`, whose solution is taken.
    output
        Files to write: .csv (a row for each sensor), and .png, .svg or .pdf (isolines of grids).
    """
    from ..sensors import outputs as of_sensors

    of_sensors.check(output)

    import radiosity as rd

    from ..sensors.groups import check_levels, parts_of
    from .progress import bar

    options = asdict(tracing) | asdict(running)
    cut = {"size": options.pop("patch_size"), "cells": options.pop("cells")}
    if options["rays"] is not None and options["error"] is not None:
        raise MethodError("give one of --rays and --error, not both")
    outputs.spare(places.points, output)
    loaded, scene_read = cut_of(scene, cut, reading, output)
    observers = [observer_of(text) for text in places.ugr]
    only_glare = bool(observers) and replace(places, ugr=(), dim=()) == NOWHERE and not scene_read.sensors
    if only_glare:
        if output:
            raise OutputError(f"{output[0]}: the rating of glare is printed; files need sensors: give --grid or --points")
        return _rate(loaded, observers, options)
    levels = named_numbers(places.dim, "dim")
    if levels and observers:
        raise MethodError("--dim and --ugr: glare is rated with all lights as the scene has them; leave one of them out")
    if levels:
        check_levels(levels, list(parts_of(loaded.patches if isinstance(loaded, rd.Solution) else loaded, {})))
    sensors = sensors_of(scene_read, places)
    with bar() as progress:
        found = rd.measure(loaded, sensors, **options, groups=bool(levels), progress=progress)
    found = found.dimmed(levels) if levels else found
    tasks: list = [("the report", lambda: tell(found.report()))]
    if observers:
        tasks.append(("the rating of glare", lambda: _rate(loaded, observers, options)))
    failures = outputs.attempt([*tasks, *((path, partial(_write, found, path)) for path in output)])
    if failures:
        raise OutputError("; ".join(outputs.told(failures)))
    if found.status == "interrupted":
        return interrupts.status()
    return NOT_REACHED if found.status == "not reached" else 0


def cut_of(scene: str, cut: dict, reading, written) -> tuple:
    """Return the scene, patches or solution that a command names, and its scene.

    Args:
        cut: size and cells of patches, at most one of which is given.
        written: the files that the command writes.

    Raises:
        OutputError: one of them is read. MethodError: both are given, or one for a solution, which has its patches.
    """
    import radiosity as rd

    given = {f"--{name}": value for name, value in (("patch-size", cut["size"]), ("cells", cut["cells"])) if value is not None}
    if len(given) > 1:
        raise MethodError("give one of --patch-size and --cells, not both")
    if Path(scene).suffix.lower() == ".npz":
        if given:
            raise MethodError(f"{scene} holds a solution, whose patches are there already: leave {', '.join(given)} out")
        outputs.spare([scene], written)
        solution = rd.load_solution(scene)
        return solution, solution.patches.scene
    read = outputs.scene_of(scene, reading, written)
    return rd.subdivide(read, **cut) if given else read, read


def _rate(loaded, observers: list[tuple[float, ...]], options: dict) -> int:
    """Print the unified glare rating of observers."""
    import radiosity as rd

    from .progress import bar

    asked = {key: value for key, value in options.items() if key not in ("error_of", "importance")}
    with bar() as progress:
        rated = rd.unified_glare_rating(
            loaded, [o[:3] for o in observers], [o[3:] for o in observers], **asked, progress=progress
        )
    tell(rated.report())
    return 0


def _write(found, path: Path) -> None:
    found.save(path)
    tell(f"wrote {printable(path)}")
