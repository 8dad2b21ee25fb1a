"""`save_scene`: a scene as a file that reads back as the same scene.

A new format is one new module with ``write(scene, path, told)`` and one line in `SUFFIXES`.
"""

from importlib import import_module
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..image.output import check_writable
from ..scene.model import Scene
from .air import without_air
from .obj import library_of
from .told import Told
from .toml import geometry_of

SUFFIXES = {
    ".toml": "toml",
    ".glb": "gltf",
    ".gltf": "gltf",
    ".obj": "obj",
    ".ply": "ply",
    ".stl": "stl",
    ".rad": "radiance",
    ".mgf": "mgf",
    ".xml": "mitsuba",
    ".hbjson": "honeybee",
    ".vs3": "view3d",
    ".ifc": "ifc",
}
KNOWN_BANDS = (("grey",), ("red", "green", "blue"))


def files_of(path) -> tuple[Path, ...]:
    """The files that `save_scene` may write for a path: itself, and what it refers to."""
    path = Path(path)
    if path.suffix.lower() == ".toml":
        return path, geometry_of(path, ".obj"), geometry_of(path, ".glb")
    if path.suffix.lower() == ".xml":
        return path, geometry_of(path, ".serialized")
    return (path, library_of(path)) if path.suffix.lower() == ".obj" else (path,)


def save_scene(scene: Scene, path) -> None:
    """Write a scene to a file, whose suffix says the format.

    Known are .toml and .xml (with the geometry beside them), .glb, .gltf, .obj (with an .mtl beside it), .ply, .stl, .rad, .mgf,
    .hbjson (honeybee), .vs3 (View3D) and .ifc (with ifcopenshell). A warning for each kind of thing that the format cannot hold
    names what it is. A .toml holds most.

    Args:
        scene: to write.
        path: of the file.

    Raises:
        OutputError: another suffix, a file that cannot be written, an .ifc without ifcopenshell, or a scene of other bands than
            files hold, or without a surface that the format holds.

    Example:
        >>> corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
        >>> lamp = rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], reflectance=0.5, emission=100, names=["lamp"])
        >>> rd.save_scene(lamp, "lamp.toml")
        >>> rd.load_scene("lamp.toml").hash == lamp.hash
        True
    """
    path = Path(path)
    for file in files_of(path):
        check_writable(file, (*SUFFIXES, ".mtl", ".serialized"))
    if scene.n_bands not in (1, 3):
        raise OutputError(
            f"{path}: the scene has {scene.n_bands} bands ({', '.join(scene.bands)}), and scene files hold one, or red, green "
            "and blue; take fewer bands"
        )
    told = Told()
    if scene.bands not in KNOWN_BANDS:
        told.add("bands read back as grey, or as red, green and blue", scene.bands)
    scene = without_air(scene, path, told)
    with np.errstate(all="ignore"):
        import_module(f".{SUFFIXES[path.suffix.lower()]}", __package__).write(scene, path, told)
    told.report(path)
