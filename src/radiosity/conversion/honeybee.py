"""Honeybee models (HBJSON): shades, and an aperture for each face of a pane, with modifiers of honeybee-radiance.

The names of surfaces are the display names. They also stand in ``user_data``, where `scene.formats.honeybee` finds them, since
honeybee's own identifiers hold few characters, and each has to be another one. Honeybee is z-up, and its light is in W.
"""

import json
from pathlib import Path

import numpy as np

from ..scene.formats.honeybee import NAME_KEY
from ..scene.model import Scene
from ..solution.whole import whole_file
from .honeybee_layers import Layer, layers
from .honeybee_modifiers import modifier
from .names import Identifiers
from .pieces import glowing, tell_of_rest
from .plain import plain
from .radiance import LUMENS
from .sheets import Sheet, gap_of, sheet
from .told import Told
from .upright import upright

HOLDS = frozenset({"names", "reflectance", "emission", "units", "backs", "panes", "diffusing panes", "glass"})
TOLERANCE = 1e-6  # of the largest coordinate: nearer corners are one to honeybee
ANGLE = 1.0  # degrees, honeybee's default


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file.

    Raises:
        OutputError: it cannot be written.
    """
    tell_of_rest(scene, told, HOLDS)
    if scene.photometric:
        told.add(f"light in lm becomes light in W, divided by {LUMENS:g} lm/W", glowing(scene))
    turned = upright(scene, told, "honeybee's models")
    identifiers, gap = Identifiers(), gap_of(scene)
    found: dict[str, list[dict]] = {"orphaned_shades": [], "orphaned_apertures": [], "shade_meshes": []}
    modifiers = []
    for layer in layers(plain(scene, of_surfaces=True), gap, told):
        modifiers.append(modifier(layer, identifiers, 1 / LUMENS if scene.photometric else 1.0, told))
        one = sheet(scene, layer.piece, gap if layer.is_back else 0.0)
        _add(found, layer, one, turned(one.vertices), modifiers[-1]["identifier"], identifiers)
    size = float(np.abs(scene.vertices).max())
    model = {
        "type": "Model",
        "identifier": Identifiers().of(path.stem),
        "display_name": path.stem,
        "units": "Meters",
        "tolerance": float(f"{TOLERANCE * size:.0e}"),
        "angle_tolerance": ANGLE,
        "properties": {
            "type": "ModelProperties",
            "radiance": {"type": "ModelRadianceProperties", "modifiers": modifiers, "modifier_sets": []},
        },
    }
    with whole_file(path) as file:
        file.write(json.dumps(model | {key: some for key, some in found.items() if some}).encode())


def _add(found: dict[str, list[dict]], layer: Layer, one: Sheet, points: np.ndarray, by: str, identifiers: Identifiers) -> None:
    """Add the objects of a layer; its modifier is called ``by``."""
    faces = [[i for i in face if i >= 0] for face in one.faces.tolist()]
    corners = points.tolist()
    if layer.is_pane:
        for face in faces:
            shape = {"type": "Face3D", "boundary": [corners[i] for i in face]}
            more = {"is_operable": False, "boundary_condition": {"type": "Outdoors"}}
            found["orphaned_apertures"].append(_object("Aperture", layer, shape, by, identifiers) | more)
    elif len(faces) == 1:
        shape = {"type": "Face3D", "boundary": [corners[i] for i in faces[0]]}
        found["orphaned_shades"].append(_object("Shade", layer, shape, by, identifiers) | {"is_detached": False})
    else:
        shape = {"type": "Mesh3D", "vertices": corners, "faces": faces}
        found["shade_meshes"].append(_object("ShadeMesh", layer, shape, by, identifiers) | {"is_detached": False})


def _object(kind: str, layer: Layer, shape: dict, by: str, identifiers: Identifiers) -> dict:
    name = layer.piece.name
    light = {"type": f"{kind}RadiancePropertiesAbridged", "modifier": by}
    return {
        "type": kind,
        "identifier": identifiers.of(name),
        "display_name": name,
        "user_data": {NAME_KEY: name},
        "geometry": shape,
        "properties": {"type": f"{kind}PropertiesAbridged", "radiance": light},
    }
