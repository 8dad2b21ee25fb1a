"""The [[luminaire]] entries of a .toml scene as luminaires (docs/luminaires.md)."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from ....errors import SceneError
from ...assemble import warn
from ...lights.build import Placing, load_photometry, placed, point_light, tell
from ...lights.luminaire import Luminaire
from ...lights.photometry import Photometry
from ...parts import ReadOptions
from ..beside import named_file
from ..names import numbered


def luminaires_of(entries, factor: float, options: ReadOptions, source: Path, up: np.ndarray) -> list[Luminaire]:
    """Return the luminaires of a file. Each luminaire file is read once.

    Args:
        entries: of the schema.
        factor: metres of a unit of length of the file.
        options: of reading.
        source: the .toml file.
        up: (3,) the direction that is up.

    Raises:
        SceneError: a luminaire file is missing or damaged, or a value makes no sense; the message names the entry.
    """
    read: dict[tuple[Path, int | None], Photometry] = {}
    taken: dict[str, int] = {}
    result = []
    for number, entry in enumerate(entries, 1):
        for position in entry.positions or [entry.position]:
            try:
                one = _luminaire(entry, np.asarray(position) * factor, factor, options, source, read, up)
            except SceneError as error:
                said = str(error)
                raise SceneError(said if said.startswith(f"{source}: ") else f"{source}: luminaire {number}: {said}") from None
            result.append(replace(one, name=numbered(one.name, taken)))
    return result


def warn_of_y_up(entries, up: np.ndarray, source: Path) -> None:
    """Tell once that luminaires look along -z by default, where the scene seems to have y upwards."""
    unaimed = [entry for entry in entries if entry.aim is None and entry.direction is None and entry.type != "point"]
    if unaimed and up[1] == 1:
        text = f"{len(unaimed)} luminaires have neither aim nor direction, and point along -z; the scene seems to have y upwards"
        warn(f"{source}: {text}: give direction = [0, -1, 0], or [0, 0, -1] where z is up")


def _luminaire(entry, position, factor: float, options: ReadOptions, source: Path, read: dict, up: np.ndarray) -> Luminaire:
    aim = None if entry.aim is None else np.asarray(entry.aim) * factor
    common = {"position": position, "aim": aim, "direction": entry.direction, "maintenance": entry.maintenance}
    common |= {"color": entry.color, "group": entry.group, "name": entry.name}
    if entry.type is not None:
        light = {"lumens": entry.lumens, "watts": entry.power, "intensity": entry.intensity}
        return point_light(**common, **light, beam=entry.beam, field=entry.field)
    path = named_file(source, entry.file, options, "luminaire file")
    key = (path, entry.lamp_set)
    if key not in read:
        read[key] = load_photometry(path, lamp_set=entry.lamp_set)
        tell(read[key])
    turned = {"rotate": entry.rotate, "along": entry.along, "lumens": entry.lumens, "soft": entry.soft}
    return placed(read[key], Placing(**common, **turned, up=up))
