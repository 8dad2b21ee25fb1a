"""Tables of a .toml scene about what is in it: geometry files, surfaces, cameras, sensors, openings."""

from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from ...heat import HOTTEST
from ...panes import HIGHEST
from .schema_values import Bands, Direction, EmissivitiesOfSides, NotNegative, Point, Positive, Table, Unit, clear


class Geometry(Table):
    """A file of shapes."""

    file: Annotated[str, Field(min_length=1)]
    unit: Unit | None = None
    scale: Positive | None = None
    name: str | None = None


class Surface(Table):
    """The settings of surfaces with a matching name."""

    name: Annotated[str, Field(min_length=1)]
    reflectance: Bands | None = None
    transmittance: Annotated[NotNegative, AfterValidator(clear)] | None = None
    diffuse_transmittance: Bands | None = None
    refractive_index: Annotated[float, Field(gt=1, le=HIGHEST)] | None = None
    emission: Bands | None = None
    radiance: Bands | None = None
    power: Bands | None = None
    sides: Literal[1, 2] | None = None
    back: Literal["absorbs", "radiates", "passes", "open"] | None = None
    flip: bool | None = None
    patch_size: Positive | None = None
    temperature: Annotated[float, Field(ge=0, le=HOTTEST)] | None = None
    flux: float | None = None
    adiabatic: Literal[True] | None = None
    isothermal: bool | None = None
    emissivity: EmissivitiesOfSides | None = None

    @model_validator(mode="after")
    def _once(self) -> "Surface":
        if self.refractive_index is not None and self.transmittance is None:
            raise ValueError("refractive_index is of clear glass; give its transmittance at right angles, too")
        for keys in (("emission", "radiance", "power"), ("sides", "back"), ("temperature", "flux", "adiabatic")):
            given = [key for key in keys if getattr(self, key) is not None]
            if len(given) > 1:
                raise ValueError(f"{' and '.join(given)} exclude each other; give one")
        return self


class View(Table):
    """A camera, in metres."""

    origin: Point
    target: Point
    up: Point = [0.0, 0.0, 1.0]
    fov: Annotated[float, Field(gt=0, lt=180)] = 40.0
    width: Annotated[int, Field(gt=0, le=2**15)] = 800
    height: Annotated[int, Field(gt=0, le=2**15)] = 600


class SensorsEntry(Table):
    """Sensors: a grid in front of a surface, points, or points of a file."""

    name: Annotated[str, Field(min_length=1)] | None = None
    kind: Literal["plane", "cylindrical"] = "plane"
    surface: Annotated[str, Field(min_length=1)] | None = None
    height: float = 0.0
    spacing: Positive | None = None
    margin: NotNegative = 0.0
    direction: Direction | None = None
    points: Annotated[list[Point], Field(min_length=1)] | None = None
    normals: list[Direction] | None = None
    file: Annotated[str, Field(min_length=1)] | None = None

    @model_validator(mode="after")
    def _of_one_kind(self) -> "SensorsEntry":
        ways = {
            "surface": ("height", "spacing", "margin", "direction"),
            "points": ("normals", "direction"),
            "file": (),
        }
        given = [way for way in ways if getattr(self, way) is not None]
        if len(given) != 1:
            raise ValueError(f"give one of {', '.join(ways)}" + (f", not {' and '.join(given)}" if given else ""))
        idle = {key for keys in ways.values() for key in keys} - set(ways[given[0]])
        if found := sorted(key for key in idle if getattr(self, key) not in (None, 0.0)):
            raise ValueError(f"{' and '.join(found)} do not go with {given[0]}")
        if self.normals is not None and (self.direction is not None or len(self.normals) != len(self.points or ())):
            raise ValueError(f"normals has {len(self.normals)} entries; give one for each of the points, or direction for all")
        return self


class OpeningEntry(Table):
    """An opening, such as a window without a pane."""

    corners: Annotated[list[Point], Field(min_length=3, max_length=4)]
