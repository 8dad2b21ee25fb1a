"""The schema of a .toml scene (docs/scene-toml.md), checked by pydantic; its errors become ours."""

from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError

from ....errors import SceneError, shown
from ...heat import HOTTEST, MOST_EDGES
from .schema_lights import OF_SKIES, LuminaireEntry, SkyEntry, SunEntry
from .schema_tables import Geometry, OpeningEntry, SensorsEntry, Surface, View
from .schema_values import ALIKE, OF_SIDES, Positive, Table, Unit, ascending, listed


def _file(value):
    """The settings of a geometry; a path alone has none."""
    return {"file": value} if isinstance(value, str) else value


class SceneFile(Table):
    """The whole file."""

    geometry: Annotated[list[Annotated[Geometry, BeforeValidator(_file)]], Field(min_length=1), BeforeValidator(listed)]
    unit: Unit = "m"
    scale: Positive = 1.0
    photometric: bool | None = None
    surroundings: Annotated[float, Field(ge=0, le=HOTTEST)] | None = None
    wavelengths: Annotated[list[Positive], AfterValidator(ascending), BeforeValidator(listed), Field(max_length=MOST_EDGES)] = []
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

REQUIRED = {
    ("", "geometry"): 'a list of files of shapes, such as geometry = ["room.obj"]',
    ("geometry", "file"): 'a file of shapes, such as file = "room.obj"',
    ("surface", "name"): 'the surfaces that it is about, such as name = "floor", or "*" for all',
    ("camera", "origin"): "where the camera stands, such as origin = [0, 0, 1.6] in metres",
    ("camera", "target"): "what the camera looks at, such as target = [1, 0, 1.6] in metres",
    ("opening", "corners"): "three or four points, such as corners = [[0, 0, 1], [2, 0, 1], [2, 0, 2], [0, 0, 2]] in metres",
    ("sky", "type"): f'one of {", ".join(OF_SKIES)}, such as type = "uniform"',
}  # what to write where a key is missing, by table ("" for the file itself) and key


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
        wanted = REQUIRED.get(("" if len(path) == 1 else str(path[0]), str(path[-1])))
        return f"{where} is missing; write {wanted}" if wanted else f"{where} is missing"
    if fault["type"] == "too_short" and path == ["geometry"]:
        return f"{where} is empty; write {REQUIRED['', 'geometry']}"
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
