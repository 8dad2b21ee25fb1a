"""The file formats, by suffix. A new one is one new module with ``read(path, options) -> Scene`` and one line here."""

from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np

from ...errors import INSTALL, RadiosityError, SceneError
from ..assemble import ReadOptions
from ..model import Scene
from .room import check_size

FORMATS = {
    ".xml": "mitsuba",
    ".glb": "gltf",
    ".gltf": "gltf",
    ".obj": "obj",
    ".ply": "mesh",
    ".stl": "mesh",
    ".mgf": "mgf",
    ".rad": "radiance",
    ".hbjson": "honeybee",
    ".ifc": "ifc",
    ".vs3": "vs3",
    ".toml": "toml",
}


def read(path: Path, options: ReadOptions) -> Scene:
    """Read a scene file.

    Raises:
        SceneError: the file is missing, empty, of an unknown format, or not what its name says.
    """
    suffix = path.suffix.lower()
    try:
        if not path.exists():
            raise SceneError(f"{path}: no such file; built-in scenes are {_builtin_names()}")
        if path.is_dir():
            raise SceneError(f"{path}: is a folder; name a file")
        if suffix not in FORMATS:
            raise SceneError(f"{path}: unknown format '{suffix}'; known are {', '.join(FORMATS)}")
        if path.stat().st_size == 0:
            raise SceneError(f"{path}: the file is empty")
        check_size(path)
        options.files.append(path)
        with np.errstate(all="ignore"):  # numbers out of range are found by the checks, with their place
            return import_module(f".{FORMATS[suffix]}", __package__).read(path, replace(options, read=read))
    except (RadiosityError, Warning):
        raise
    except ModuleNotFoundError as error:
        raise SceneError(f"{path}: reading {suffix} files needs '{error.name}'; {INSTALL}") from error
    except PermissionError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror})") from None
    except MemoryError:
        raise SceneError(f"{path}: too large for the memory of this machine, or its sizes are damaged") from None
    except Exception as error:  # damage that no check knows: a file must never end the program with a foreign exception
        raise SceneError(f"{path}: cannot be read as {suffix} ({type(error).__name__}: {error}); is it damaged?") from error


def _builtin_names() -> str:
    from ..builtin import SCENES

    return ", ".join(SCENES)
