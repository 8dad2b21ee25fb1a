"""Materials of Wavefront MTL files."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...assemble import Material, ReadOptions, warn
from ...model import Back
from ..beside import warn_of_case
from ..color import unit_rgb
from ..encoding import read_text
from ..textures import warn_of_black
from .mtl_map import Map, Maps
from .text import lines

UNREAD = {"disp": "displacements", "decal": "decals"}  # what changes shape or colour; bumps and highlights are not diffuse
LARGEST = 1e30  # what is multiplied by a texture stays finite


@dataclass(frozen=True, eq=False)
class Finish:
    """A material with its textures."""

    material: Material
    base: Map | None = None
    emissive: Map | None = None


def read_library(path: Path, options: ReadOptions, codec: str) -> dict[str, Finish]:
    """The materials of a library by name. ``Kd`` is the reflectance, ``Ke`` a radiance.

    Textures that are missing or damaged are left out with one warning (an error where ``options.strict``). Of several
    materials of one name the last holds.

    Args:
        codec: of the file that asks for the library.

    Raises:
        SceneError: a value that is no number.
    """
    entries: dict[str, dict[str, tuple[int, str]]] = {}
    current: dict[str, tuple[int, str]] = {}
    again: dict[str, None] = {}
    for number, words in lines(read_text(path, hint=codec).text):
        if words[0].lower() == "newmtl":
            name = " ".join(words[1:])
            again |= {name: None} if name in entries else {}
            current = entries[name] = {}
        else:
            current[words[0].lower()] = (number, " ".join(words[1:]))
    if again:
        warn(f"{path}: materials that are defined again; the last definition holds: {shown(again)}")
    maps = Maps(path, options)
    result = {name: _finish(path, entry, maps) for name, entry in entries.items()}
    warn_of_case(path, maps.renamed)
    _warn_of_rest(path, entries)
    if maps.lost:
        warn(f"{path}: textures that cannot be read are left out: {'; '.join(dict.fromkeys(maps.lost))}")
    if maps.ignored:
        warn(f"{path}: options of textures that are not followed: {shown(maps.ignored)}; bake them into the image")
    see_through = [
        name
        for name, entry in entries.items()
        if _number(path, entry, "d", 1.0) < 1 or _number(path, entry, "tr", 0.0) > 0 or "map_d" in entry
    ]
    if see_through:
        warn(f"{path}: transparency is left out, taken as opaque: {shown(see_through)}; transmittance in a .toml makes panes")
    return result


def _warn_of_rest(path: Path, entries: dict) -> None:
    """Tell of statements that change colour or shape and are not read."""
    curves = [name for name, entry in entries.items() if any(_is(entry, key, "spectral") for key in ("kd", "ke"))]
    if curves:
        warn(f"{path}: colours that are spectral curves (.rfl) are not read, write them as red, green and blue: {shown(curves)}")
    converted = [name for name, entry in entries.items() if any(_is(entry, key, "xyz") for key in ("kd", "ke"))]
    if converted:
        warn(f"{path}: CIE XYZ colours become red, green and blue of an equal-energy white: {shown(converted)}")
    pairs = [(name, key.title()) for name, entry in entries.items() for key in ("kd", "ke") if f"map_{key}" in entry]
    warn_of_black(path, {name: key for name, key in pairs if not any(_color(path, entries[name], key.lower()) or (1.0,))})
    for key, what in UNREAD.items():
        if names := [name for name, entry in entries.items() if key in entry]:
            warn(f"{path}: {what} ({key}) are left out: {shown(names)}")


def _is(entry: dict, key: str, kind: str) -> bool:
    return key in entry and entry[key][1].split()[:1] == [kind]


def _finish(path: Path, entry: dict, maps: Maps) -> Finish:
    base, emissive = (maps.read(*entry[key]) if key in entry else None for key in ("map_kd", "map_ke"))
    diffuse = _color(path, entry, "kd")
    if diffuse is None and base is not None:
        diffuse = (1.0,)
    radiance = _color(path, entry, "ke") or ((0.0,) if emissive is None else (1.0,))
    specular = max(_color(path, entry, "ks") or (0.0,))
    illumination = _number(path, entry, "illum", 2.0)
    # many programs write Ks 0.5 with illum 2 for everything: only what outweighs Kd, or is traced as a mirror, counts
    glossy = (illumination >= 3 and specular > 0) or (illumination >= 2 and specular > max(diffuse or (1.0,)))
    material = Material(
        reflectance=diffuse,
        emission=tuple(np.pi * v for v in radiance),
        back=Back.RADIATES,
        diffuse=not (glossy or _number(path, entry, "pm", 0.0) > 0),
        origin=str(path),
    )
    return Finish(material, base, emissive if any(radiance) else None)


def _floats(path: Path, entry: dict, key: str) -> list[float] | None:
    if key not in entry:
        return None
    line, rest = entry[key]
    try:
        return [float(word) for word in rest.split()]
    except ValueError:
        raise SceneError(f"{path}, line {line}: '{key} {rest}' is not understood; expected numbers") from None


def _number(path: Path, entry: dict, key: str, default: float) -> float:
    if key == "d" and key in entry:
        entry = {key: (entry[key][0], entry[key][1].replace("-halo", ""))}
    values = _floats(path, entry, key)
    return values[0] if values else default


def _color(path: Path, entry: dict, key: str) -> tuple[float, ...] | None:
    if _is(entry, key, "spectral"):
        return None
    xyz = _is(entry, key, "xyz")
    if xyz:
        entry = {key: (entry[key][0], entry[key][1].split(None, 1)[-1].removeprefix("xyz"))}
    values = _floats(path, entry, key)
    if not values:
        return None
    if len(values) == 2:
        raise SceneError(f"{path}, line {entry[key][0]}: {key} is {shown(values)}; expected one number, or red, green and blue")
    values = values[:3] if len(values) >= 3 else values[:1]
    if not all(0 <= v < LARGEST for v in values):
        raise SceneError(
            f"{path}, line {entry[key][0]}: {key} is {shown(values)}; values must be below {LARGEST:g} and not negative"
        )
    if xyz and len(values) == 3 and values[1] > 0:
        total = sum(values)
        values = [float(v) for v in values[1] * unit_rgb(values[0] / total, values[1] / total)]
    return tuple(values[:1] if len(set(values)) == 1 else values)
