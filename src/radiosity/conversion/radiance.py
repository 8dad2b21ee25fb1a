"""Radiance's scene description (.rad): a material and polygons for each surface. Numbers keep all their digits.

Radiance's surfaces have two sides, and lamps shine from their fronts alone. Its unit is W: light in lm is divided by 179 lm/W,
which its programs take for white light.
"""

from pathlib import Path

import numpy as np

from ..scene.model import Scene
from ..solution.whole import whole_file
from .names import unique_names, word
from .pieces import glowing, tell_of_rest
from .plain import plain
from .radiance_materials import material
from .radiance_sky import far_lights
from .sheets import Sheet, sheets
from .told import Told

LUMENS = 179.0  # a watt, as Radiance's programs have it
HOLDS = frozenset({"names", "reflectance", "emission", "units", "backs", "panes", "diffusing panes", "glass", "lights", "open"})


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file.

    Raises:
        OutputError: it cannot be written.
    """
    tell_of_rest(scene, told, HOLDS)
    told.add("luminaires are left out", [lamp.name for lamp in scene.lights.luminaires])
    if scene.photometric:
        told.add(f"light in lm becomes light in W, divided by {LUMENS:g} lm/W", [*glowing(scene), *_far(scene)])
    watts = 1 / LUMENS if scene.photometric else 1.0
    parts = sheets(plain(scene, of_surfaces=True), told)
    names = unique_names([sheet.piece for sheet in parts], told, word)
    with whole_file(path) as file:
        file.write(b"# written by radiosity; lengths in metres, radiances in W/(m2 sr)\n")
        file.write("".join(far_lights(scene.lights, watts, told)).encode())
        for sheet, name in zip(parts, names, strict=True):
            file.write(material(name, sheet.piece, watts, told).encode())
            for text in polygons(name, sheet):
                file.write(text.encode())


def polygons(name: str, sheet: Sheet):
    """Yield a statement for each face; the material is called like the surface."""
    corners = [" ".join(map(repr, point)) for point in sheet.vertices.tolist()]
    for face in sheet.faces.tolist():
        ring = [corners[i] for i in face if i >= 0]
        yield f"{name} polygon {name}\n0\n0\n{3 * len(ring)}\n  " + "\n  ".join(ring) + "\n"


def _far(scene: Scene) -> list[str]:
    sky = scene.lights.sky
    return [sun.name for sun in scene.lights.suns] + ([sky.name] if sky is not None and np.any(sky.radiance) else [])
