"""Scenes: the model, the readers of files and the built-in ones."""

import os
from pathlib import Path

from ..errors import SceneError
from .assemble import ReadOptions
from .model import Back, Camera, Scene

__all__ = ["Back", "Camera", "Scene", "load_scene"]


def load_scene(name, *, max_reflectance: float = 0.95, strict: bool = False, allow_outside: bool = False) -> Scene:
    """Load a scene file, or build a built-in scene by its name.

    Args:
        name: path of a .xml (Mitsuba), .glb, .gltf, .obj, .ply, .stl, .mgf, .rad (Radiance), .hbjson (honeybee), .ifc, .vs3
            (View3D) or .toml file, or a built-in scene: ``cornell-box``, ``room``, ``rooms``, ``studio``, ``labyrinth``.
        max_reflectance: larger reflectances in the file are brought down to this, with one warning.
        strict: faults in a file that could be skipped with a warning are errors.
        allow_outside: the file may name others (includes, meshes, textures) that lie outside its folder.

    Raises:
        SceneError: the file cannot be used; the message says why and what to do.

    Example:
        >>> scene = rd.load_scene("cornell-box")
        >>> scene.bands, scene.n_faces
        (('red', 'green', 'blue'), 21)
    """
    return load_with_files(name, max_reflectance=max_reflectance, strict=strict, allow_outside=allow_outside)[0]


def load_with_files(name, **options) -> tuple[Scene, list[Path]]:
    """Load a scene as `load_scene` does, and return it with the files that it was read from."""
    from . import builtin, formats

    if not isinstance(name, str | os.PathLike):
        raise SceneError(f"load_scene takes a path or the name of a built-in scene, not {type(name).__name__}")
    if str(name) in builtin.SCENES:
        return builtin.SCENES[str(name)](), []
    root = None if options.pop("allow_outside", False) else Path(os.path.realpath(Path(name).parent))
    how = ReadOptions(**options, root=root)
    return formats.read(Path(name), how), how.files
