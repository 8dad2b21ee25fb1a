"""Wavefront OBJ with an MTL file beside it: an object for each surface. Numbers keep all their digits.

Its faces have two sides, so backs are those of fronts. Reflectance is ``Kd``, and emission ``Ke``, a radiance.
"""

from pathlib import Path

import numpy as np

from ..errors import printable
from ..scene.formats.obj.tables import NO_NAME
from ..scene.model import Scene
from ..solution.whole import whole_file
from .names import unique_names
from .pieces import Piece, pieces, tell_of_rest
from .plain import plain
from .told import Told

HOLDS = frozenset({"names", "reflectance", "emission"})


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file and its materials.

    Raises:
        OutputError: one of them cannot be written.
    """
    tell_of_rest(scene, told, HOLDS)
    parts = pieces(plain(scene, of_surfaces=True), told, backs="alike")
    names, library, lines = object_names(parts, told), library_of(path), []
    for piece, name in zip(parts, names, strict=True):
        lines += [f"newmtl {name}", f"Kd {_numbers(piece.reflectance)}", f"Ke {_numbers(piece.emission / np.pi)}", "illum 1"]
    with whole_file(library) as file:
        file.write(("\n".join(lines) + "\n").encode())
    write_geometry(scene, path, parts, names, library.name)


def library_of(path: Path) -> Path:
    """Return the .mtl of an .obj: without blanks, at which many programs end the name of a library."""
    return path.with_name("_".join(path.stem.split()) + ".mtl")


def write_geometry(scene: Scene, path: Path, parts: list[Piece], names: list[str], library: str = "") -> None:
    """Write the faces of pieces as objects of these names, with materials of the same names where there is a library.

    Raises:
        OutputError: the file cannot be written.
    """
    with whole_file(path) as file:
        head = "# written by radiosity; lengths in metres\n" + (f"mtllib {library}\n" if library else "")
        file.write(head.encode())
        file.write("".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in scene.vertices.tolist()).encode())
        for piece, name in zip(parts, names, strict=True):
            file.write(f"o {name}\n{f'usemtl {name}' if library else 's off'}\n".encode())
            for row in (piece.corners + 1).tolist():
                file.write(f"f {row[0]} {row[1]} {row[2]}{f' {row[3]}' if row[3] > 0 else ''}\n".encode())


def object_names(parts: list[Piece], told: Told) -> list[str]:
    """Return a name for each piece that an OBJ file can hold; each is another one."""
    return unique_names(parts, told, _of_objects)


def _of_objects(name: str) -> str:
    name = printable(" ".join(name.split()))
    return "" if name.lower() in NO_NAME or name.startswith("#") or " #" in name or name.endswith("\\") else name


def _numbers(values: np.ndarray) -> str:
    return " ".join(map(repr, values.tolist()))
