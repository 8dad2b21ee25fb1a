"""``radiosity measure``"""

from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Group, Parameter

from ..errors import MethodError, OutputError, SceneError, printable
from . import amounts, interrupts, outputs
from .exchange import named_numbers
from .options import Count, Length, Outputs, Share
from .solve import NOT_REACHED
from .solve_options import RUN, Machine, SceneOptions, Unset
from .streams import tell

Texts = Annotated[tuple[str, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)]
Tables = Annotated[tuple[Path, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)]
Observers = Annotated[tuple[str, ...], Parameter(allow_leading_hyphen=True, negative=(), show_default=False)]  # one each time
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}


@dataclass(frozen=True)
class Places:
    """The places where light is measured. Default: what the [[sensors]] of a .toml scene say.

    Attributes:
        grid: Grids in front of surfaces, as NAME,HEIGHT,SPACING, such as floor,0.8,0.5 or floor,80cm. They follow the surface's
            outline. Without SPACING it is that of EN 12464-1, without HEIGHT sensors lie on the surface.
        points: Tables of points, .csv: x,y,z in metres and, where the planes do not look up, nx,ny,nz.
        margin: How far the sensors of grids stay away from the outline, in metres.
        dim: Levels of groups of lights, such as "row 1=0.5" window=0, of which each is measured by itself: luminaires by group or
            name, suns, the sky, and surfaces that emit by name. Others stay at 1.
        kind: plane, or cylindrical: the mean of all planes that contain the axis, as on an upright cylinder.
        ugr: Observers whose unified glare rating is found, as X,Y,Z,DX,DY,DZ: the eye in metres, and the line of sight; --ugr
            again for another one.
    """

    grid: Texts = ()
    points: Tables = ()
    margin: Length = None
    dim: Texts = ()
    kind: Literal["plane", "cylindrical"] = "plane"
    ugr: Observers = ()


@dataclass(frozen=True)
class Tracing:
    """How many lines, and patches.

    Attributes:
        rays: Number of lines in all, such as 2M.
        error: Trace until the relative error is below this, such as 1% (the default); in 95 % of runs the true error then is. A
            run that ends above it has the exit status 3.
        error_of: What --error is the error of: the mean of each set of sensors, or the worst sensor.
        patch_size: Longest edge of a patch, in metres. Default: about 20 000 patches in all.
        cells: Cut every face into CELLS x CELLS patches.
    """

    rays: Count = None
    error: Share = None
    error_of: Literal["mean", "worst"] = "mean"
    patch_size: Length = None
    cells: Count = None


@dataclass(frozen=True)
class Running(Machine):
    """What concerns the run.

    Attributes:
        replicates: Number of independent randomised runs, from which errors are found. Default: 8, or those of the solution.
    """

    replicates: Count = None


PlaceOptions = Annotated[Places, Parameter(name="*", group=Group("The sensors", sort_key=1))]
TracingOptions = Annotated[Tracing, Parameter(name="*", group=Group("Lines and patches", sort_key=2))]
RunningOptions = Annotated[Running, Parameter(name="*", group=RUN)]
NOWHERE, USUAL, PLAIN = Places(), Tracing(), Running()


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
    given = {f"--{name}": value for name, value in (("patch-size", cut["size"]), ("cells", cut["cells"])) if value is not None}
    if len(given) > 1:
        raise MethodError("give one of --patch-size and --cells, not both")
    if Path(scene).suffix.lower() == ".npz":
        if given:
            raise MethodError(f"{scene} holds a solution, whose patches are there already: leave {', '.join(given)} out")
        loaded = rd.load_solution(scene)
        scene_read = loaded.patches.scene
    else:
        loaded = rd.load_scene(scene, **asdict(reading))
        scene_read = loaded
        loaded = rd.subdivide(loaded, **cut) if given else loaded
    observers = [_observer(text) for text in places.ugr]
    only_glare = bool(observers) and replace(places, ugr=(), dim=()) == NOWHERE and not scene_read.sensors
    if only_glare:
        if output:
            raise OutputError(f"{output[0]}: the rating of glare is printed; files need sensors: give --grid or --points")
        return _rate(loaded, observers, options)
    levels = named_numbers(places.dim, "dim")
    if levels and observers:
        raise MethodError("--dim and --ugr: glare is rated with all lights as the scene has them; leave one of them out")
    if levels:
        if isinstance(loaded, rd.Solution):
            raise MethodError(f"{scene} holds a solution of all lights together; --dim needs the scene")
        check_levels(levels, list(parts_of(loaded, {})))
    sensors = _sensors(scene_read, places)
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


def _rate(loaded, observers: list[tuple[float, ...]], options: dict) -> int:
    """Print the unified glare rating of observers."""
    import radiosity as rd

    from .progress import bar

    asked = {key: value for key, value in options.items() if key != "error_of"}
    with bar() as progress:
        rated = rd.unified_glare_rating(
            loaded, [o[:3] for o in observers], [o[3:] for o in observers], **asked, progress=progress
        )
    tell(rated.report())
    return 0


def _observer(text: str) -> tuple[float, ...]:
    try:
        return amounts.numbers(text, 6)
    except ValueError:
        raise SceneError(f"--ugr is '{text}'; write X,Y,Z,DX,DY,DZ: the eye, and the line of sight") from None


def _write(found, path: Path) -> None:
    found.save(path)
    tell(f"wrote {printable(path)}")


def _sensors(scene, places: Places):
    """Return the sensors that options ask for, or those of the scene's file."""
    import radiosity as rd

    from ..scene.up import up_vector

    if not places.grid and not places.points:
        if replace(places, ugr=(), dim=()) != NOWHERE:
            raise SceneError("--margin and --kind need sensors: give --grid or --points")
        if not scene.sensors:
            raise SceneError(
                f"{scene.source}: asks for no sensors; give --grid such as floor,0.8,0.5, or --points FILE.csv, or write "
                "[[sensors]] in a .toml scene"
            )
        return rd.Sensors.of_scene(scene)
    if places.margin is not None and not places.grid:
        raise SceneError("--margin is of grids: give --grid, or leave it out")
    sets, taken = [], set()
    for text in places.grid:
        surface, height, spacing = grid_of(text)
        name = surface if surface not in taken else f"{surface} {height:g} m"
        taken.add(name)
        sizes = {"height": height, "spacing": spacing, "margin": places.margin or 0.0}
        sets.append(rd.Sensors.grid(scene, surface, **sizes, name=name, kind=places.kind))
    sets += [rd.Sensors.from_csv(path, kind=places.kind, normal=up_vector(scene)) for path in places.points]
    return sum(sets[1:], sets[0])


def grid_of(text: str) -> tuple[str, float, float | None]:
    """Return name, height and spacing, m, of NAME,HEIGHT,SPACING; the last two may be left out.

    Raises:
        SceneError: it has no name.
    """
    name, numbers = text.removeprefix("surface:"), []
    while len(numbers) < 2 and "," in name and (value := _length(name.rpartition(",")[2])) is not None:
        name, numbers = name.rpartition(",")[0], [value, *numbers]
    if not name:
        raise SceneError(f"--grid is '{text}'; write NAME,HEIGHT,SPACING, such as floor,0.8,0.5")
    height, spacing = [*numbers, *[None] * 2][:2]
    return name, height or 0.0, spacing


def _length(text: str) -> float | None:
    """Return metres, of any sign; None where it is no length."""
    text = text.strip()
    unit = next((unit for unit in ("mm", "cm", "m") if text.endswith(unit)), "")
    try:
        return float(text.removesuffix(unit)) * UNITS.get(unit, 1.0)
    except ValueError:
        return None
