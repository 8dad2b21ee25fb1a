"""Tables of a .toml scene about lights that are no surfaces: luminaires, the sky, the sun."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from .schema_values import Bands, NotNegative, Point, Positive, Table, listed

OF_TYPES = ("power", "intensity", "beam", "field")  # keys that a file leaves no room for
OF_FILES = ("rotate", "along", "soft", "lamp_set")  # keys that only a file has use for


class LuminaireEntry(Table):
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


class _Far(Table):
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
    openings: Annotated[list[str], BeforeValidator(listed)] = []
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
