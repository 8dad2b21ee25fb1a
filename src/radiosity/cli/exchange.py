"""``radiosity exchange``"""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Group, Parameter

from ..errors import MethodError, OutputError, SceneError, printable
from . import outputs
from .options import Count, Length, Outputs, Share
from .solve import NOT_REACHED
from .solve_options import RUN, Replicated, SceneOptions, Unset
from .streams import tell

Names = Annotated[tuple[str, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)]


@dataclass(frozen=True)
class Conditions:
    """What is known of the surfaces; it goes before what a .toml scene says.

    Attributes:
        temperature: Temperatures in K of surfaces, such as floor=310 "wall*=290". NAME may be a pattern.
        emissivity: Emissivities of surfaces, such as "*=0.9" shield=0.05, of one side such as shield:front=0.05, or in bands,
            such as oven=0.9,0.4, with --wavelengths.
        flux: W that a whole surface gets from elsewhere and gives off, such as heater=500.
        adiabatic: Names of surfaces that get no heat from elsewhere: insulated walls, shields.
        isothermal: Names of those of them that conduct well, so that the whole surface has one temperature.
        surroundings: Temperature of the black surroundings, in K. A scene that lines leave needs it.
        wavelengths: Edges between bands of emissivity, in micrometres, such as 3,8.
    """

    temperature: Names = ()
    emissivity: Names = ()
    flux: Names = ()
    adiabatic: Names = ()
    isothermal: Names = ()
    surroundings: float | None = None
    wavelengths: str | None = None


@dataclass(frozen=True)
class Tracing:
    """How many lines, and how they are traced.

    Attributes:
        rays: Number of lines in all, such as 2M (the default); beside --error the limit.
        error: Trace until the relative error of net heat is below this, such as 1%; in 95 % of runs the true error then is. A run
            that ends above it has the exit status 3.
        error_of: What --error is the error of: net:NAME or temperature:NAME. Default: all net heat, relative to the largest.
        patch_size: Longest edge of a patch, in metres. Default: about 2 000 patches in all.
        cells: Cut every face into CELLS x CELLS patches.
        cluster: Trace on the workers of Dask, as of `radiosity solve`: tcp://HOST:PORT, or local:N.
    """

    rays: Count = None
    error: Share = None
    error_of: str | None = None
    patch_size: Length = None
    cells: Count = None
    cluster: str | None = None


ConditionOptions = Annotated[Conditions, Parameter(name="*", group=Group("The conditions", sort_key=1))]
TracingOptions = Annotated[Tracing, Parameter(name="*", group=Group("Lines and patches", sort_key=2))]
RunningOptions = Annotated[Replicated, Parameter(name="*", group=RUN)]
NO_CONDITIONS, USUAL, PLAIN = Conditions(), Tracing(), Replicated()


def exchange(
    scene: str,
    /,
    *,
    output: Outputs = (),
    given: ConditionOptions = NO_CONDITIONS,
    tracing: TracingOptions = USUAL,
    running: RunningOptions = PLAIN,
    reading: SceneOptions = Unset.reading,
) -> int:
    """Find the heat that surfaces exchange by radiation: net watts and temperatures, with error bars.

    Conditions stand in a .toml scene, or are given here. Net heat is positive where a surface heats the others.

    Parameters
    ----------
    scene
        A scene file (.xml .glb .gltf .obj .ply .stl .mgf .rad .hbjson .ifc .vs3 .toml), a built-in scene, or an .npz file of
        `radiosity lines`, whose lines are taken.
    output
        Files to write: .csv (the table; beside it NAME.exchange.csv, watts from surface to surface), .npz, .png (a view of net
        heat; beside it NAME.exchange.png, a matrix of watts, and NAME.flows.png, which shows them as bands).
    """
    from ..exchange.files import check_writable, files_of

    written: dict[Path, Path] = {}
    for path in output:
        for place in (file.resolve() for file in files_of(path)):
            if place in written:
                raise OutputError(f"{path} writes {place.name}, and so does {written[place]}; give each output its own name")
            written[place] = path
        check_writable(path)

    import radiosity as rd

    from .progress import bar

    of_lines = Path(scene).suffix.lower() == ".npz"
    options, usual = (asdict(one) | asdict(other) for one, other in ((tracing, running), (USUAL, PLAIN)))
    if of_lines and options != usual:
        changed = [f"--{key.replace('_', '-')}" for key, value in options.items() if value != usual[key]]
        raise MethodError(f"{scene} holds lines that are there already: leave {', '.join(changed)} out, or give the scene")
    cut = {"size": options.pop("patch_size"), "cells": options.pop("cells")}
    outputs.spare([scene], written)
    loaded = rd.load_lines(scene) if of_lines else outputs.scene_of(scene, reading, written)
    asked = any(value is not None for value in cut.values())
    patches = rd.subdivide(loaded, **cut) if isinstance(loaded, rd.Scene) and asked else loaded
    conditions = {
        "temperature": named_numbers(given.temperature, "temperature"),
        "emissivity": named_numbers(given.emissivity, "emissivity", several=True, sides=True),
        "flux": named_numbers(given.flux, "flux"),
        "adiabatic": given.adiabatic,
        "isothermal": given.isothermal,
        "surroundings": given.surroundings,
        "wavelengths": None if given.wavelengths is None else _numbers(given.wavelengths, "wavelengths", given.wavelengths),
    }
    with bar() as progress:
        found = rd.radiative_exchange(patches, **conditions, **options, progress=progress)
    tasks = [("the table", lambda: tell(found.report()))]
    failures = outputs.attempt([*tasks, *((path, lambda path=path: _write(found, path)) for path in output)])
    if failures:
        raise OutputError("; ".join(outputs.told(failures)))
    if found.status == "interrupted":
        from . import interrupts

        return interrupts.status()
    return NOT_REACHED if found.status == "not reached" else 0


def _write(found, path: Path) -> None:
    found.export(path)
    tell(f"wrote {printable(path)}")


def named_numbers(given: tuple[str, ...], what: str, *, several: bool = False, sides: bool = False) -> dict:
    """Values by name, from NAME=VALUE; the last = divides. With ``sides``, NAME:front and NAME:back are one side each."""
    found: dict = {}
    for text in given:
        name, equals, value = text.rpartition("=")
        if not equals or not name:
            raise SceneError(f"--{what} is '{text}'; write NAME=VALUE, such as floor=0.9")
        surface, _, side = name.rpartition(":")
        place, key = found, name
        if sides and surface and side in ("front", "back"):
            place, key = found.setdefault(surface, {}), side
        if not isinstance(place, dict) or key in place:
            raise SceneError(f"--{what} gives '{name}' twice")
        numbers = _numbers(value, what, text)
        if len(numbers) > 1 and not several:
            raise SceneError(f"--{what} is '{text}'; give one number")
        place[key] = numbers[0] if len(numbers) == 1 else numbers
    return found


def _numbers(text: str, what: str, whole: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise SceneError(f"--{what} is '{whole}'; '{text}' is no number") from None
