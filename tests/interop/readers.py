"""Which other programs read each format, and how."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from . import (
    by_blender,
    by_mitsuba,
    by_numpy_stl,
    by_radiance,
    by_trimesh,
    write_gltf,
    write_mgf,
    write_mitsuba,
    write_obj,
    write_ply,
    write_stl,
)
from .draw import Sample
from .run import Reader, each


@dataclass(frozen=True)
class Format:
    """A file format: what writes it, and who else reads it."""

    write: Callable[[Path, int], Sample]
    readers: dict[str, Reader]


def _needs(module: str):
    return lambda: None if find_spec(module) else f"'{module}' is not installed"


def _blender_missing() -> str | None:
    return None if by_blender.python() else f"'bpy' is not installed, and {by_blender.PYTHON} names no Python that has it"


def _blender(name, called=str, whole=False, **options) -> Reader:
    """``name(path)`` makes a function from an object's and a material's name to ours."""

    def read_all(paths, folder):
        found = []
        for path, records in by_blender.read_all(paths, folder).items():
            try:
                found.append(by_blender.reading(records, name(path), **options))
            except by_blender.Refused as error:
                found.append(error)
        return found

    return Reader(read_all, called=called, whole=whole, missing=_blender_missing)


def _last(name: str) -> str:
    """An OBJ surface by its innermost group, and its material (those of ``write_obj`` begin with mat)."""
    parts = name.split("/")
    return "/".join(parts[-2:] if parts[-1].lower().startswith("mat") else parts[-1:])


def _gltf_name(thing: str, material: str) -> str:
    """Blender makes a default material where vertex colours have none."""
    return thing if not material or material.startswith("DefaultMaterial") else f"{thing}/{material}"


def _numbered(name: str) -> str:
    """Blender's numbers of equal names."""
    return re.sub(r"#(\d+)", lambda match: f".{int(match[1]) - 1:03d}", name)


TRIMESH, MITSUBA = _needs("trimesh"), _needs("mitsuba")

FORMATS = {
    "obj": Format(
        write_obj.write,
        {
            "trimesh": Reader(each(by_trimesh.obj), whole=True, missing=TRIMESH),
            "mitsuba": Reader(each(by_mitsuba.mesh), whole=True, missing=MITSUBA),
            "blender": _blender(lambda path: lambda thing, material: f"{thing}/{material}" if material else thing, called=_last),
        },
    ),
    "ply": Format(
        write_ply.write,
        {
            "trimesh": Reader(each(by_trimesh.ply), missing=TRIMESH),
            "mitsuba": Reader(each(by_mitsuba.mesh), whole=True, spared=frozenset({"lists before"}), missing=MITSUBA),
            "blender": _blender(lambda path: lambda thing, material: path.stem),
        },
    ),
    "stl": Format(
        write_stl.write,
        {
            "trimesh": Reader(each(by_trimesh.stl), whole=True, missing=TRIMESH),
            "numpy-stl": Reader(each(by_numpy_stl.read), missing=_needs("stl")),
            "blender": _blender(lambda path: lambda thing, material: "all", whole=True, color=False),
        },
    ),
    "gltf": Format(
        write_gltf.write,
        {
            "trimesh": Reader(each(by_trimesh.gltf), whole=True, missing=TRIMESH),
            "blender": _blender(lambda path: _gltf_name, called=_numbered, sides=True),
        },
    ),
    "mitsuba": Format(
        write_mitsuba.write,
        {"mitsuba": Reader(each(by_mitsuba.scene), missing=MITSUBA, hidden=("copy",), more=by_mitsuba.rays)},
    ),
    "mgf": Format(
        write_mgf.write,
        {"radiance": Reader(each(by_radiance.read), missing=_needs("pyradiance"), more=by_radiance.rays)},
    ),
}
