"""The [sky], [sun] and [[opening]] of a .toml scene (docs/daylight.md)."""

from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from ....errors import SceneError, shown
from ...assemble import warn
from ...lights.color import colored
from ...lights.model import Lights
from ...lights.openings import opening
from ...lights.perez import DEW_POINT
from ...lights.skies import cie_sky, uniform_sky
from ...lights.sky import Sky
from ...lights.sun import DIAMETER, Sun
from ...lights.sun import sun as sun_of
from ...lights.sun_position import YEAR, day_of_year, sun_position
from ...lights.weather import epw_sky, perez_sky
from ...model import Scene
from ...parts import ReadOptions
from ..beside import named_file


def daylight_of(asked: Any, scene: Scene, factor: float, options: ReadOptions, source: Path, up: np.ndarray) -> Lights:
    """Return the sky, the suns, and the openings of a file.

    Args:
        asked: of the schema.
        scene: what the file describes besides.
        factor: metres of a unit of length of the file.
        options: of reading.
        source: the .toml file.
        up: (3,) the direction that seems to be up.

    Raises:
        SceneError: a value makes no sense; the message names the entry.
    """
    try:
        sky, suns = _far(asked, options, source, up)
    except SceneError as error:
        said = str(error)
        raise SceneError(said if said.startswith(str(source)) else f"{source}: {said}") from None
    named = [] if asked.sky is None else _of_surfaces(asked.sky.openings, scene, source)
    own = [opening(entry.corners, f"{source}: opening {number}") for number, entry in enumerate(asked.opening, 1)]
    polygons = [*named, *(one * factor for one in own)]
    if polygons and not (sky or suns or scene.lights.sky or scene.lights.suns):
        raise SceneError(f"{source}: openings are for the light of a sky or a sun; add [sky], or leave them out")
    return Lights(suns=suns, sky=sky, openings=np.concatenate(polygons) if polygons else None)


def _far(asked: Any, options: ReadOptions, source: Path, up: np.ndarray) -> tuple[Sky | None, tuple[Sun, ...]]:
    sky, sun = asked.sky, asked.sun
    if sky is None and sun is None:
        return None, ()
    in_lumens = sky is not None or sun.illuminance is not None if asked.photometric is None else asked.photometric
    frame = _frame(sky, sun, source, "y" if up[1] == 1 else "z")
    if _place(sky) and _place(sun) and _place(sky) != _place(sun):
        raise SceneError(f"sky and sun place the sun at {_place(sky)} and {_place(sun)} (altitude, azimuth); give its place once")
    suns = () if sun is None else (_sun(sun, _place(sun) or _place(sky), frame, in_lumens),)
    if sky is None:
        return None, suns
    if suns and sky.type in ("perez", "epw"):
        raise SceneError(f"the sky of type {sky.type} has a sun of its own; leave [sun] out, or take another type of sky")
    found, suns = _sky(sky, None if sun is None else _place(sun), suns, frame, in_lumens, options, source)
    return colored(found, sky.color), tuple(colored(one, sky.sun_color) for one in suns)


def _sun(entry: Any, place: tuple[float, float] | None, frame: dict, in_lumens: bool) -> Sun:
    """Return the sun of an entry, at a place where it gives no direction."""
    light = entry.illuminance if in_lumens else entry.irradiance
    if light is None:
        given, unit, key = ("irradiance", "W/m²", "illuminance") if in_lumens else ("illuminance", "lm/m²", "irradiance")
        how = "the light of a sky is in lm/m² unless photometric = false" if in_lumens else "photometric is false"
        raise SceneError(f"sun: {given} is in {unit}, and {how}; give {key}, or photometric = {str(not in_lumens).lower()}")
    altitude, azimuth = (None, None) if place is None or entry.direction else place
    found = sun_of(
        light,
        altitude=altitude,
        azimuth=azimuth,
        direction=entry.direction,
        diameter=DIAMETER if entry.diameter is None else entry.diameter,
        photometric=in_lumens,
        name=entry.name,
        **frame,
    )
    return colored(found, entry.color)


def _sky(entry, place, suns, frame: dict, in_lumens: bool, options: ReadOptions, source: Path):
    """Return the sky of an entry, and its suns; ``place`` is that of the [sun]."""
    common = {**frame, "ground": entry.ground, "photometric": in_lumens, "name": entry.name}
    diameter = DIAMETER if entry.diameter is None else entry.diameter
    if entry.type == "epw":
        path = named_file(source, entry.file, options, "weather file")
        return epw_sky(path, entry.month, entry.day, int(entry.hour), diameter=diameter, **common)
    here = _place(entry)
    if entry.type == "perez":
        if here is None:
            raise SceneError("sky: a sky of type perez needs the sun's altitude and azimuth, or place and date")
        date = {} if entry.month is None else {"day": day_of_year(entry.month, entry.day, entry.year or YEAR)}
        dew_point = DEW_POINT if entry.dew_point is None else entry.dew_point
        return perez_sky(entry.direct, entry.diffuse, sun=here, diameter=diameter, dew_point=dew_point, **date, **common)
    if entry.type == "uniform":
        return uniform_sky(entry.horizontal, suns=suns, **common), suns
    kind = entry.cie_type if entry.type == "cie-general" else entry.type.removeprefix("cie-")
    return cie_sky(kind, entry.horizontal, sun=here or place, suns=suns, **common), suns


def _place(entry: Any) -> tuple[float, float] | None:
    """Return the sun's altitude and azimuth that an entry gives, degrees."""
    if entry is None or (entry.altitude is None and entry.latitude is None):
        return None
    if entry.altitude is not None:
        return entry.altitude, entry.azimuth
    where = entry.latitude, entry.longitude, entry.timezone
    return sun_position(*where, entry.month, entry.day, entry.hour, entry.year or YEAR)


def _frame(sky: Any, sun: Any, source: Path, seen: str) -> dict:
    """Return up and north, which the sky and the sun share; ``seen`` is the axis that seems to be up."""
    found = {}
    for key in ("up", "north"):
        given = {name: getattr(entry, key) for name, entry in (("sky", sky), ("sun", sun)) if entry is not None}
        values = {name: value for name, value in given.items() if value is not None}
        if len(values) == 2 and values["sky"] != values["sun"]:
            raise SceneError(f"sky and sun have different {key}: {values['sky']} and {values['sun']}; give it once")
        found[key] = next(iter(values.values()), None)
    if found["up"] is None:
        found["up"] = "z"
        if seen == "y":
            warn(f'{source}: the sky and the sun take z as up; the scene seems to have y upwards: give up = "y", or up = "z"')
    return found


def _of_surfaces(patterns: list[str], scene: Scene, source: Path) -> list[np.ndarray]:
    """Return the faces of surfaces as openings, (n, 4, 3) m each."""
    found = []
    for pattern in patterns:
        names = [i for i, name in enumerate(scene.names) if name == pattern or fnmatchcase(name, pattern)]
        if not names:
            raise SceneError(
                f"{source}: sky: openings: no surface is called '{pattern}'; there are {shown(sorted(scene.names), 20)}"
            )
        faces = scene.faces[np.isin(scene.surface, names)]
        found.append(scene.vertices[np.where(faces < 0, faces[:, 2:3], faces)])
    return found
