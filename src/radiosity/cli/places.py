"""The places where ``radiosity measure`` measures: grids, points, observers."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Group, Parameter

from ..errors import SceneError
from . import amounts
from .options import Length

Texts = Annotated[tuple[str, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)]
Tables = Annotated[tuple[Path, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)]
Observers = Annotated[tuple[str, ...], Parameter(allow_leading_hyphen=True, negative=(), show_default=False)]  # one each time
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}


@dataclass(frozen=True)
class Points:
    """The points where light is measured. Default: what the [[sensors]] of a .toml scene say.

    Attributes:
        grid: Grids in front of surfaces, as NAME,HEIGHT,SPACING, such as floor,0.8,0.5 or floor,80cm. They follow the surface's
            outline. Without SPACING it is that of EN 12464-1, without HEIGHT sensors lie on the surface.
        points: Tables of points, .csv: x,y,z in metres and, where the planes do not look up, nx,ny,nz.
        margin: How far the sensors of grids stay away from the outline, in metres.
        kind: plane, or cylindrical: the mean of all planes that contain the axis, as on an upright cylinder.
    """

    grid: Texts = ()
    points: Tables = ()
    margin: Length = None
    kind: Literal["plane", "cylindrical"] = "plane"


@dataclass(frozen=True)
class Places(Points):
    """The points where light is measured, and what else is asked there.

    Attributes:
        dim: Levels of groups of lights, such as "row 1=0.5" window=0, of which each is measured by itself: luminaires by group or
            name, suns, the sky, and surfaces that emit by name. Others stay at 1.
        ugr: Observers whose unified glare rating is found, as X,Y,Z,DX,DY,DZ: the eye in metres, and the line of sight.
            Give the option again for another one.
    """

    dim: Texts = ()
    ugr: Observers = ()


SENSORS = Group("The sensors", sort_key=1)
PointOptions = Annotated[Points, Parameter(name="*", group=SENSORS)]
PlaceOptions = Annotated[Places, Parameter(name="*", group=SENSORS)]
NOWHERE = Places()


def sensors_of(scene, places: Points):
    """Return the sensors that options ask for, or those of the scene's file."""
    import radiosity as rd

    from ..scene.up import up_vector

    if not places.grid and not places.points:
        if (places.margin, places.kind) != (None, NOWHERE.kind):
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


def observer_of(text: str) -> tuple[float, ...]:
    """Return the eye and the line of sight, of X,Y,Z,DX,DY,DZ.

    Raises:
        SceneError: other text.
    """
    try:
        return amounts.numbers(text, 6)
    except ValueError:
        raise SceneError(f"--ugr is '{text}'; write X,Y,Z,DX,DY,DZ: the eye, and the line of sight") from None
