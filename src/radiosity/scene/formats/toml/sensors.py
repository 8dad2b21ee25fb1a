"""The [[sensors]] entries of a .toml scene (docs/sensors.md)."""

from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...model import Scene
from ...parts import ReadOptions
from ...sensor_request import SensorRequest
from ...sensor_table import read
from ..beside import named_file


def sensors_of(entries, factor: float, scene: Scene, options: ReadOptions, source: Path, up) -> tuple[SensorRequest, ...]:
    """Return the sensors that a file asks for.

    Args:
        entries: of the schema.
        factor: metres of a unit of length of the file.
        scene: of all geometry.
        options: of reading.
        source: the .toml file.
        up: (3,) the direction in which planes look that have none.

    Raises:
        SceneError: no such surface or file, a file that cannot be read, or two sets of one name; it names the entry.
    """
    up = tuple(up.tolist())
    made: dict[str, SensorRequest] = {}
    for number, entry in enumerate(entries, 1):
        where = f"{source}: sensors {number}"
        if entry.surface is not None and not any(
            name == entry.surface or fnmatchcase(name, entry.surface) for name in scene.names
        ):
            raise SceneError(f"{where}: no surface is called '{entry.surface}'; there are {shown(scene.names, 20)}")
        for one in _requests(entry, number, factor, up, options, source):
            if one.name in made:
                raise SceneError(f"{where}: an entry before it is called '{one.name}', too; give each a name of its own")
            made[one.name] = one
    return tuple(made.values())


def _requests(entry, number: int, factor: float, up, options: ReadOptions, source: Path) -> list[SensorRequest]:
    direction = None if entry.direction is None else tuple(entry.direction)
    if entry.surface is not None:
        spacing = None if entry.spacing is None else entry.spacing * factor
        sizes = {"height": entry.height * factor, "spacing": spacing, "margin": entry.margin * factor}
        return [SensorRequest(entry.name or entry.surface, entry.kind, entry.surface, **sizes, direction=direction)]
    if entry.points is not None:
        every = [tuple(direction or up)] * len(entry.points)
        normals = every if entry.normals is None else [tuple(normal) for normal in entry.normals]
        points = [tuple(one) for one in np.multiply(entry.points, factor).tolist()]
        return [SensorRequest(entry.name or f"sensors {number}", entry.kind, points=tuple(points), normals=tuple(normals))]
    found = read(named_file(source, entry.file, options, "table of sensors"), entry.name, up)
    return [
        SensorRequest(
            name,
            entry.kind,
            points=tuple(map(tuple, (points * factor).tolist())),
            normals=tuple(map(tuple, normals.tolist())),
        )
        for name, points, normals in found
    ]
