"""The parts of a honeybee model (HBJSON) that are read, checked by pydantic; its errors become ours. Other keys are left out."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ....errors import SceneError

Point = Annotated[list[float], Field(min_length=3, max_length=3)]
Loop = Annotated[list[Point], Field(min_length=3)]
Units = Literal["Meters", "Millimeters", "Feet", "Inches", "Centimeters"]
Named = str | dict[str, Any] | None  # a modifier, or a set of them: its identifier, or itself


class _Table(BaseModel):
    model_config = ConfigDict(extra="ignore", allow_inf_nan=False)


class Polygon(_Table):
    """A flat polygon, counterclockwise seen from its front, with holes."""

    boundary: Loop
    holes: list[Loop] | None = None


class Mesh(_Table):
    """Vertices, and faces of three or four."""

    vertices: list[Point]
    faces: list[Annotated[list[Annotated[int, Field(ge=0, lt=2**31)]], Field(min_length=3, max_length=4)]]


class Radiance(_Table):
    """What an object says about light."""

    modifier: Named = None
    modifier_set: Named = None
    dynamic_group_identifier: str | None = None


class Properties(_Table):
    """What an object says about all fields; light is read."""

    radiance: Radiance | None = None


class Condition(_Table):
    """What is behind a face: Outdoors, Ground, Surface and so on, and of a Surface its identifiers."""

    type: str = "Outdoors"
    boundary_condition_objects: list[str] = []


class UserData(_Table):
    """What programs keep with an object; `save_scene` keeps the name of its surface."""

    radiosity: str | None = None


class Object(_Table):
    """Anything with a name and properties."""

    identifier: str
    user_data: UserData | None = None
    properties: Properties = Properties()

    @property
    def light(self) -> Radiance:
        """What it says about light."""
        return self.properties.radiance or Radiance()

    def called(self, kind: str) -> str:
        """Return the name of its surface: the one that was kept, or its kind and identifier."""
        kept = None if self.user_data is None else self.user_data.radiosity
        return f"{kind}/{self.identifier}" if kept is None else kept


class Shade(Object):
    """A surface that is no part of a room's walls."""

    geometry: Polygon
    is_detached: bool = False


class ShadeMesh(Object):
    """A shade of many faces."""

    geometry: Mesh
    is_detached: bool = True


class Shaded(Object):
    """An object that holds shades."""

    indoor_shades: list[Shade] | None = None
    outdoor_shades: list[Shade] | None = None


class Aperture(Shaded):
    """A window."""

    geometry: Polygon
    boundary_condition: Condition = Condition()
    is_operable: bool = False


class Door(Shaded):
    """A door."""

    geometry: Polygon
    boundary_condition: Condition = Condition()
    is_glass: bool = False


class Face(Shaded):
    """A wall, floor or ceiling, with its windows and doors, which are no holes of its polygon."""

    geometry: Polygon
    face_type: Literal["Wall", "Floor", "RoofCeiling", "AirBoundary"]
    boundary_condition: Condition = Condition()
    apertures: list[Aperture] | None = None
    doors: list[Door] | None = None


class Room(Shaded):
    """A room, whose faces look outward."""

    faces: list[Face]


class WholeSet(BaseModel):
    """The set of modifiers of a whole model, which brings modifiers of its own."""

    model_config = ConfigDict(extra="allow")
    modifiers: list[dict[str, Any]] = []


class ModelRadiance(_Table):
    """Modifiers and sets of them, and what is for programs of honeybee alone."""

    modifiers: list[dict[str, Any]] = []
    modifier_sets: list[dict[str, Any]] = []
    global_modifier_set: "WholeSet | None" = None
    sensor_grids: list[Any] | None = None
    views: list[Any] | None = None
    luminaires: list[Any] | None = None


class ModelProperties(_Table):
    """What a model says about light."""

    radiance: ModelRadiance | None = None


class Model(_Table):
    """The whole file."""

    type: Literal["Model"]
    units: Units = "Meters"
    properties: ModelProperties = ModelProperties()
    rooms: list[Room] | None = None
    orphaned_faces: list[Face] | None = None
    orphaned_apertures: list[Aperture] | None = None
    orphaned_doors: list[Door] | None = None
    orphaned_shades: list[Shade] | None = None
    shade_meshes: list[ShadeMesh] | None = None


def checked(values: Any, source: str) -> Model:
    """The file's values.

    Raises:
        SceneError: something is missing or out of range; the message says where.
    """
    if isinstance(values, dict) and values.get("type") != "Model":
        kind = str(values.get("type", "no type"))[:40]
        raise SceneError(f"{source}: holds '{kind}' and no honeybee Model; write the model by honeybee's Model.to_hbjson")
    try:
        return Model.model_validate(values)
    except ValidationError as error:
        faults = [f"{_place(fault['loc'])}: {fault['msg']}" for fault in error.errors()[:3]]
        raise SceneError(f"{source}: is no valid honeybee model: {'; '.join(faults)}") from None


def _place(steps: tuple[int | str, ...]) -> str:
    """Return the place of a fault, such as ``rooms 2, faces 1, geometry``; numbers begin with 1."""
    text = ""
    for step in steps:
        text += f" {step + 1}" if isinstance(step, int) else f"{', ' if text else ''}{step}"
    return text or "the file"
