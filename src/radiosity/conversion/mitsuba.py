"""Mitsuba 3 XML with its meshes beside it (``NAME.geometry.serialized``): a shape for each surface, lamps, cameras.

Coordinates are 64-bit numbers, and colours are read as 32-bit ones. Emitters shine from their fronts alone.
"""

from collections.abc import Iterator
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from ..errors import printable
from ..scene.model import Scene
from ..solution.whole import whole_file
from .mitsuba_bsdf import bsdf
from .mitsuba_lights import lights_of
from .mitsuba_tags import rgb, transform
from .names import unique_names
from .pieces import tell_of_rest
from .plain import plain
from .serialized import pack
from .sheets import Sheet, sheets
from .told import Told
from .toml import geometry_of

HOLDS = frozenset({"names", "reflectance", "emission", "backs", "panes", "diffusing panes", "lights", "cameras", "open"})
MADE_UP = ("_arg_", "_unnamed", "__root__")  # beginnings of names that Mitsuba gives


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file and its meshes.

    Raises:
        OutputError: one of them cannot be written.
    """
    tell_of_rest(scene, told, HOLDS)
    if scene.photometric:
        told.add("lights in lm read back as lights in W", [light.name for light in scene.lights.all])
    parts = sheets(plain(scene, of_surfaces=True), told)
    names = unique_names([one.piece for one in parts], told, name_of, mark=" ")
    geometry = geometry_of(path, ".serialized")
    with whole_file(geometry) as file:
        for block in pack([(one.vertices, one.faces) for one in parts], names):
            file.write(block)
    lines = ['<?xml version="1.0" encoding="utf-8"?>', "<!-- written by radiosity; lengths in metres -->"]
    lines += ['<scene version="3.0.0">', '  <integrator type="path"/>']
    lines += [text for camera in scene.cameras for text in _camera(camera)]
    lines += lights_of(scene.lights, set(names), told)
    for index, (one, name) in enumerate(zip(parts, names, strict=True)):
        lines += _shape(one, name, geometry.name, index, told)
    with whole_file(path) as file:
        file.write(("\n".join(lines) + "\n</scene>\n").encode())


def name_of(name: str) -> str:
    """Return a name as Mitsuba takes it: without points, which part its paths, and without the sign of parameters."""
    name = printable(" ".join(name.split())).replace(".", "_").replace("$", "_")
    return "" if name.startswith(MADE_UP) else name


def _shape(one: Sheet, name: str, file: str, index: int, told: Told) -> Iterator[str]:
    yield f'  <shape type="serialized" id={quoteattr(name)}>'
    yield f'    <string name="filename" value={quoteattr(file)}/>'
    yield f'    <integer name="shape_index" value="{index}"/>'
    yield '    <boolean name="face_normals" value="true"/>'
    yield from (f"    {text}" for text in bsdf(one.piece, told))
    if one.piece.emission.any():
        yield f'    <emitter type="area">{rgb("radiance", one.piece.emission / np.pi)}</emitter>'
    yield "  </shape>"


def _camera(camera) -> Iterator[str]:
    yield '  <sensor type="perspective">'
    yield f'    <float name="fov" value="{camera.fov!r}"/>'
    yield '    <string name="fov_axis" value="y"/>'
    yield f"    {transform(camera.origin, np.subtract(camera.target, camera.origin), camera.up)}"
    size = " ".join(f'<integer name="{key}" value="{int(getattr(camera, key))}"/>' for key in ("width", "height"))
    yield f'    <film type="hdrfilm">{size}</film>'
    yield "  </sensor>"
