"""TOML with the geometry beside it: the format that holds most (docs/scene-toml.md).

The geometry is ``NAME.geometry.obj``, whose numbers keep all their digits. Where the scene has textures it is
``NAME.geometry.glb``, which holds them.
"""

import json
from pathlib import Path

import numpy as np

from ..scene.clear_glass import of_mean, share_at
from ..scene.lights.model import Lights
from ..scene.model import Back, Scene
from ..scene.photopic import PHOTOPIC
from ..solution.whole import whole_file
from . import gltf, webs
from .obj import object_names, write_geometry
from .pieces import Piece, pieces, tell_of_rest
from .told import Told
from .toml_heat import of_surface

HOLDS = frozenset({"names", "reflectance", "emission", "units", "backs", "panes", "textures", "lights", "openings", "open"}) | {
    "cameras",
    "sensors",
    "heat",
    "patch sizes",
    "diffusing panes",
    "glass",
}
BACKS = {Back.ABSORBS: "absorbs", Back.RADIATES: "radiates", Back.PASSES: "passes", Back.OPEN: "open"}


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file and its geometry.

    Raises:
        OutputError: one of them cannot be written.
    """
    tell_of_rest(scene, told, HOLDS)
    painted = scene.reflectance_paint is not None or scene.emission_paint is not None
    parts = pieces(scene, told)
    if painted:
        geometry = geometry_of(path, ".glb")
        names = gltf.write_geometry(scene, geometry, told)
        entries = _entries_beside(scene, parts, names, told)
    else:
        geometry = geometry_of(path, ".obj")
        names = object_names(parts, told)
        write_geometry(scene, geometry, parts, names)
        entries = [_entry(scene, parts, piece, name, told) for piece, name in zip(parts, names, strict=True)]
    lines = [f"geometry = {_value(geometry.name)}", f"photometric = {_value(scene.photometric)}"]
    heat = scene.heat
    if heat is not None and heat.surroundings is not None:
        lines.append(f"surroundings = {_value(float(heat.surroundings))}")
    if heat is not None and heat.wavelengths:
        lines.append(f"wavelengths = {_value(heat.wavelengths)}")
    tables = [("surface", entry) for entry in entries]
    tables += [("camera", _camera(camera)) for camera in scene.cameras]
    tables += [("luminaire", entry) for entry in _luminaires(scene.lights, told)]
    tables += [("sensors", _sensors(request)) for request in scene.sensors]
    far = list(_far(scene, told))
    if far:  # without sky and sun openings are an error
        tables += [("opening", {"corners": _corners(corners)}) for corners in _openings(scene.lights)]
    for name, entry in tables:
        lines += ["", f"[[{name}]]", *(f"{key} = {_value(value)}" for key, value in entry.items())]
    for name, entry in far:
        lines += ["", f"[{name}]", *(f"{key} = {_value(value)}" for key, value in entry.items())]
    with whole_file(path) as file:
        file.write(("\n".join(lines) + "\n").encode())


def geometry_of(path: Path, suffix: str) -> Path:
    """Return the file beside a .toml that holds its geometry; a scene of the same name in another format is not written over."""
    return path.with_name(f"{path.stem}.geometry{suffix}")


def _entry(scene: Scene, parts: list[Piece], piece: Piece, name: str, told: Told) -> dict:
    entry: dict = {"name": name, "reflectance": piece.reflectance, "emission": piece.emission, "back": BACKS[piece.back]}
    return entry | _light_through(piece) | of_surface(scene, parts, piece, told)


def _light_through(piece: Piece) -> dict:
    """What an entry says of a pane; of glass its transmittance at right angles."""
    entry: dict = {}
    if piece.transmittance:
        entry["transmittance"] = piece.transmittance
    if piece.refractive_index:
        index = piece.refractive_index
        entry["transmittance"] = float(share_at(np.ones(1), of_mean(piece.transmittance, index), index)[0])
        entry["refractive_index"] = index
    return entry | ({"diffuse_transmittance": piece.diffuse} if piece.diffuse.any() else {})


def _entries_beside(scene: Scene, parts: list[Piece], names: list[str], told: Told) -> list[dict]:
    """Entries where the geometry holds reflectance and emission: those that say more."""
    found = []
    for piece, name in zip(parts, names, strict=True):
        entry: dict = {"name": name} | ({} if piece.back in (Back.ABSORBS, Back.RADIATES) else {"back": BACKS[piece.back]})
        entry |= _light_through(piece)
        entry |= of_surface(scene, parts, piece, told)
        if len(entry) > 1:
            found.append(entry)
    return found


def _camera(camera) -> dict:
    return {
        "origin": camera.origin,
        "target": camera.target,
        "up": camera.up,
        "fov": float(camera.fov),
        "width": int(camera.width),
        "height": int(camera.height),
    }


def _luminaires(lights: Lights, told: Told):
    """Yield entries of lamps that shine alike in all directions; others need a luminaire file."""
    for lamp in lights.luminaires:
        if not webs.uniform(lamp):
            told.add("luminaires with a web of intensities are left out; name their files in [[luminaire]]", [lamp.name])
            continue
        entry: dict = {"type": "point", "position": lamp.position, "name": lamp.name}
        mean = float(lamp.power[0]) if len(lamp.power) == 1 else float(PHOTOPIC @ lamp.power)
        entry["lumens" if lamp.photometric else "power"] = mean
        if len(lamp.power) == 3 and (lamp.power != lamp.power[0]).any():
            entry["color"] = lamp.power
        yield entry | ({"group": lamp.group} if lamp.group else {})


def _sensors(request) -> dict:
    entry: dict = {"name": request.name, "kind": request.kind}
    if request.surface is None:
        return entry | {"points": request.points, "normals": request.normals}
    entry |= {"surface": request.surface, "height": request.height, "margin": request.margin}
    for key in ("spacing", "direction"):
        if getattr(request, key) is not None:
            entry[key] = getattr(request, key)
    return entry


def _openings(lights: Lights) -> np.ndarray:
    return np.zeros((0, 4, 3)) if lights.openings is None else lights.openings


def _corners(corners: np.ndarray) -> np.ndarray:
    return corners[:3] if (corners[3] == corners[2]).all() else corners


def _far(scene: Scene, told: Told):
    """Yield the tables of the sun and of a uniform sky."""
    lights = scene.lights
    for number, sun in enumerate(lights.suns):
        if number:
            told.add("suns after the first are left out", [sun.name])
            continue
        key = "illuminance" if sun.photometric else "irradiance"
        yield "sun", {"name": sun.name, key: sun.irradiance, "direction": sun.direction, "diameter": float(sun.diameter)}
    sky = lights.sky
    if sky is None:
        return
    rows = len(sky.radiance) // 2
    upper, lower = sky.radiance[rows:], sky.radiance[:rows]
    if np.ptp(upper) == 0 and not lower.any():
        level = float(sky.horizontal[0])
        yield "sky", {"type": "uniform", "name": sky.name, "horizontal": level, "up": sky.axes[2], "north": sky.axes[0]}
    else:
        told.add("skies that are not uniform are left out; write [sky] anew", [sky.name])


def _value(value) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float | np.floating):
        return repr(float(value))
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {_value(one)}' for key, one in value.items())} }}"
    return f"[{', '.join(_value(one if np.ndim(one) else float(one)) for one in value)}]"
