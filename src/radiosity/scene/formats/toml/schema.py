"""The schema of a .toml scene (docs/scene-toml.md), checked by pydantic; its errors become ours."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    model_validator,
)

from ....errors import SceneError, shown
from ...heat import HOTTEST, MOST_EDGES
from ...panes import HIGHEST

Unit = Literal["m", "cm", "mm", "in", "ft"]
Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]


def _listed(value):
    """A list; one entry becomes a list of one."""
    return [value] if isinstance(value, (int, float, str)) else value


def _one_or_three(value: list[float]) -> list[float]:
    if len(value) not in (1, 3):
        raise ValueError(f"expected one number or [red, green, blue], not {len(value)} numbers")
    return value


def _ascending(value: list[float]) -> list[float]:
    if any(one >= other for one, other in pairwise(value)):
        raise ValueError("expected edges between bands in micrometres, ascending")
    return value


def _clear(value: float) -> float:
    if value >= 1:
        raise ValueError("expected a share below 1; what lets all light through is not there: leave the surface out")
    return value


def _pointing(value: list[float]) -> list[float]:
    if not any(value):
        raise ValueError("expected a direction, not three zeros")
    return value


Bands = Annotated[list[NotNegative], BeforeValidator(_listed), AfterValidator(_one_or_three)]
Emissivities = Annotated[list[Annotated[float, Field(gt=0, le=1)]], Field(min_length=1), BeforeValidator(_listed)]
ALIKE, OF_SIDES = "alike", "of sides"  # emissivities: those of both sides together, or of each
EmissivitiesOfSides = Annotated[
    Annotated[Emissivities, Tag(ALIKE)]
    | Annotated[Annotated[dict[Literal["front", "back"], Emissivities], Field(min_length=1)], Tag(OF_SIDES)],
    Discriminator(lambda value: OF_SIDES if isinstance(value, dict) else ALIKE),
]
Point = Annotated[list[float], Field(min_length=3, max_length=3)]
Direction = Annotated[Point, AfterValidator(_pointing)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


class Geometry(_Table):
    """A file of shapes."""

    file: Annotated[str, Field(min_length=1)]
    unit: Unit | None = None
    scale: Positive | None = None
    name: str | None = None


def _file(value):
    """The settings of a geometry; a path alone has none."""
    return {"file": value} if isinstance(value, str) else value


class Surface(_Table):
    """The settings of surfaces with a matching name."""

    name: Annotated[str, Field(min_length=1)]
    reflectance: Bands | None = None
    transmittance: Annotated[NotNegative, AfterValidator(_clear)] | None = None
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


class View(_Table):
    """A camera, in metres."""

    origin: Point
    target: Point
    up: Point = [0.0, 0.0, 1.0]
    fov: Annotated[float, Field(gt=0, lt=180)] = 40.0
    width: Annotated[int, Field(gt=0, le=2**15)] = 800
    height: Annotated[int, Field(gt=0, le=2**15)] = 600


class LuminaireEntry(_Table):
    """A lamp without area: of a file, or of a type."""

    file: Annotated[str, Field(min_length=1)] | None = None
    type: Literal["point", "spot"] | None = None
    position: Point | None = None
    positions: Annotated[list[Point], Field(min_length=1)] | None = None
    aim: Point | None = None
    direction: Point | None = None
    rotate: float = 0.0
    along: Point | None = None
    lumens: Positive | None = None
    power: Positive | None = None
    intensity: Positive | None = None
    beam: Positive | None = None
    field: Positive | None = None
    maintenance: Annotated[float, Field(gt=0, le=1)] = 1.0
    color: Annotated[list[NotNegative], Field(min_length=3, max_length=3)] | None = None
    group: str = ""
    name: str | None = None
    soft: bool = False
    lamp_set: Annotated[int, Field(ge=1)] | None = None

    @model_validator(mode="after")
    def _of_one_kind(self) -> "LuminaireEntry":
        if (self.file is None) == (self.type is None):
            raise ValueError('give file = "NAME.ies" or "NAME.ldt", or else type = "point" or "spot"')
        others = OF_TYPES if self.type is None else OF_FILES if self.type == "spot" else (*OF_FILES, "beam", "field")
        found = [key for key in others if getattr(self, key) not in (None, False, 0.0)]
        if found:
            raise ValueError(f"{' and '.join(found)} do not go with {'a file' if self.type is None else f'type {self.type}'}")
        if self.type == "spot" and self.beam is None:
            raise ValueError("a spot needs beam, the full angle of half its intensity in degrees")
        if self.aim is not None and self.direction is not None:
            raise ValueError("aim and direction exclude each other; give one")
        if (self.position is None) == (self.positions is None):
            raise ValueError("give position = [x, y, z], or positions = [[x, y, z], ...] for several that are alike")
        return self


class SensorsEntry(_Table):
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


OF_TYPES = ("power", "intensity", "beam", "field")  # keys that a file leaves no room for
OF_FILES = ("rotate", "along", "soft", "lamp_set")  # keys that only a file has use for


Up = Literal["y", "z"] | Point
PLACE = ("altitude", "azimuth", "latitude", "longitude", "timezone", "year")
DATE = ("month", "day", "hour")
OF_SKIES = {  # the keys that a sky of each type needs, and those that it may have
    "uniform": (("horizontal",), ()),
    "cie-overcast": (("horizontal",), ()),
    "cie-clear": (("horizontal",), (*PLACE, *DATE)),
    "cie-intermediate": (("horizontal",), (*PLACE, *DATE)),
    "cie-general": (("horizontal", "cie_type"), (*PLACE, *DATE)),
    "perez": (("direct", "diffuse"), ("dew_point", "diameter", "sun_color", *PLACE, *DATE)),
    "epw": (("file", *DATE), ("diameter", "sun_color")),
}


class _Far(_Table):
    """Keys that the sky and the sun share."""

    altitude: Annotated[float, Field(ge=-90, le=90)] | None = None
    azimuth: Annotated[float, Field(ge=-360, le=360)] | None = None
    latitude: Annotated[float, Field(ge=-90, le=90)] | None = None
    longitude: Annotated[float, Field(ge=-180, le=180)] | None = None
    timezone: Annotated[float, Field(ge=-14, le=14)] | None = None
    month: Annotated[int, Field(ge=1, le=12)] | None = None
    day: Annotated[int, Field(ge=1, le=31)] | None = None
    hour: Annotated[float, Field(ge=0, le=24)] | None = None
    year: int | None = None
    color: Annotated[list[NotNegative], Field(min_length=3, max_length=3)] | None = None
    diameter: Annotated[float, Field(ge=0, lt=180)] | None = None
    up: Up | None = None
    north: Point | None = None

    @model_validator(mode="after")
    def _placed_once(self) -> "_Far":
        angles, whole = ("altitude", "azimuth"), ("latitude", "longitude", "timezone", *DATE)
        given = [key for key in (*angles, *whole) if getattr(self, key) is not None]
        weather = getattr(self, "type", None) == "epw"  # which has the place in its file
        if not weather and given and set(given) not in (set(angles), set(whole)):
            raise ValueError(f"to place the sun give {' and '.join(angles)}, or {', '.join(whole)} (given: {', '.join(given)})")
        return self


class SkyEntry(_Far):
    """The sky."""

    type: Literal["uniform", "cie-overcast", "cie-clear", "cie-intermediate", "cie-general", "perez", "epw"]
    horizontal: NotNegative | None = None
    cie_type: Annotated[int, Field(ge=1, le=15)] | None = None
    direct: NotNegative | None = None
    diffuse: NotNegative | None = None
    dew_point: float | None = None
    file: Annotated[str, Field(min_length=1)] | None = None
    ground: Annotated[float, Field(ge=0, le=1)] = 0.0
    openings: Annotated[list[str], BeforeValidator(_listed)] = []
    sun_color: Annotated[list[NotNegative], Field(min_length=3, max_length=3)] | None = None
    name: str = "sky"

    @model_validator(mode="after")
    def _of_its_type(self) -> "SkyEntry":
        needed, more = OF_SKIES[self.type]
        lacking = [key for key in needed if getattr(self, key) is None]
        if lacking:
            raise ValueError(f"a sky of type {self.type} needs {', '.join(lacking)}")
        every = {key for pair in OF_SKIES.values() for keys in pair for key in keys}
        idle = [key for key in sorted(every - {*needed, *more}) if getattr(self, key) is not None]
        if idle:
            raise ValueError(f"a sky of type {self.type} has no use for {', '.join(idle)}; leave them out")
        if self.type == "epw" and (self.hour is None or self.hour not in range(1, 25)):
            raise ValueError("hour is the number of an hour of the file, 1 to 24, which ends at that number")
        return self


class SunEntry(_Far):
    """The sun."""

    irradiance: Bands | None = None
    illuminance: Bands | None = None
    direction: Point | None = None
    name: str = "sun"

    @model_validator(mode="after")
    def _one_light(self) -> "SunEntry":
        if (self.irradiance is None) == (self.illuminance is None):
            raise ValueError("give irradiance (W/m²) or illuminance (lm/m²), across the light")
        if self.direction is not None and any(getattr(self, key) is not None for key in (*PLACE, *DATE)):
            raise ValueError("direction and the sun's place exclude each other; give one")
        return self


class OpeningEntry(_Table):
    """An opening, such as a window without a pane."""

    corners: Annotated[list[Point], Field(min_length=3, max_length=4)]


class SceneFile(_Table):
    """The whole file."""

    geometry: Annotated[list[Annotated[Geometry, BeforeValidator(_file)]], Field(min_length=1), BeforeValidator(_listed)]
    unit: Unit = "m"
    scale: Positive = 1.0
    photometric: bool | None = None
    surroundings: Annotated[float, Field(ge=0, le=HOTTEST)] | None = None
    wavelengths: Annotated[
        list[Positive], AfterValidator(_ascending), BeforeValidator(_listed), Field(max_length=MOST_EDGES)
    ] = []
    surface: list[Surface] = []
    camera: list[View] = []
    luminaire: list[LuminaireEntry] = []
    sensors: list[SensorsEntry] = []
    sky: SkyEntry | None = None
    sun: SunEntry | None = None
    opening: list[OpeningEntry] = []


TABLES = {
    "surface": Surface,
    "camera": View,
    "geometry": Geometry,
    "luminaire": LuminaireEntry,
    "sensors": SensorsEntry,
    "sky": SkyEntry,
    "sun": SunEntry,
    "opening": OpeningEntry,
}

ARRAYS = {
    "geometry": 'write a list of files, such as geometry = ["room.obj"], or [[geometry]] with two brackets for each',
    "surface": "write [[surface]] with two brackets, one for each entry",
    "camera": "write [[camera]] with two brackets, one for each entry",
    "luminaire": "write [[luminaire]] with two brackets, one for each entry",
    "sensors": "write [[sensors]] with two brackets, one for each entry",
    "opening": "write [[opening]] with two brackets, one for each entry",
}  # what to write where something else than a list is given


def checked(values: dict, source: str) -> SceneFile:
    """The file's values.

    Raises:
        SceneError: unknown keys (says which exist), missing ones, values out of range.
    """
    try:
        return SceneFile.model_validate(values)
    except ValidationError as error:
        faults = dict.fromkeys(_sentence(fault, values) for fault in error.errors())
        raise SceneError(f"{source}: {'; '.join(list(faults)[:3])}") from None


def _sentence(fault, values: dict) -> str:
    path: list = [step for step in fault["loc"] if step not in (ALIKE, OF_SIDES, "[key]")]
    where = ", ".join(
        f"{step} {path[i + 1] + 1}" if i + 1 < len(path) and isinstance(path[i + 1], int) else str(step)
        for i, step in enumerate(path)
        if isinstance(step, str)
    )
    if path[0] == "surface" and len(path) > 1 and isinstance(values["surface"][path[1]], dict):
        where = where.replace(",", f" ('{values['surface'][path[1]].get('name', '')}'),", 1)
    if fault["type"] == "extra_forbidden":
        table = TABLES.get(str(path[0]), SceneFile) if len(path) > 1 else SceneFile
        return f"{where}: unknown key; known are {shown(table.model_fields, 30)}"
    if fault["type"] == "missing":
        return f"{where} is missing"
    if fault["type"] == "list_type" and str(path[-1]) in ARRAYS:
        return f"{where}: {ARRAYS[str(path[-1])]} (it is {_kind(fault['input'])})"
    if fault["type"] in ("dict_type", "model_type"):
        if path[0] in ("sky", "sun") and len(path) == 1:
            return f"{where}: write [{where}] with one bracket, once (it is {fault['input']!r})"
        key = {"geometry": "file", "luminaire": "file", "sensors": "surface"}.get(str(path[0]), "name")
        return f'{where}: write a table, such as {{ {key} = "..." }} (it is {fault["input"]!r})'
    text = fault["msg"].removeprefix("Value error, ").removesuffix(" or instance of Geometry")
    return f"{where}: {text}" + (f" (it is {fault['input']!r})" if not isinstance(fault["input"], dict) else "")


def _kind(value) -> str:
    return "one table; with two brackets it is one of a list" if isinstance(value, dict) else repr(value)
