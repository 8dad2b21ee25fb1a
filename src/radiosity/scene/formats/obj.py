"""Wavefront OBJ: a part for every (object, group, material); quadrilaterals stay whole, backs radiate.

Read here and not through trimesh, which merges groups and takes relative vertex numbers for absolute ones. Lengths
are metres. ``Kd`` times texture times vertex colour (sRGB, as programs write it) is the reflectance, ``Ke`` a radiance.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ...errors import SceneError, shown
from ..assemble import Material, Part, ReadOptions, assemble, warn
from ..model import Scene
from .faces import cut
from .mtl import Finish, read_library, read_text
from .textures import decode_srgb, warn_of_means, with_means

NO_NAME = ("", "default", "off", "(null)")
FREE_FORM = ("curv", "curv2", "surf")
NONE = -1


@dataclass(eq=False)
class _Tables:
    """What the lines say: numbers, and the corners of the faces by surface."""

    vertices: list[list[float]] = field(default_factory=list)
    uv: list[list[float]] = field(default_factory=list)
    groups: dict[tuple[str, str], list[list[tuple[int, int]]]] = field(default_factory=dict)  # (name, material) -> faces
    libraries: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    free_form: int = 0
    highest: dict[str, tuple[int, int]] = field(default_factory=dict)  # number used of a table, and its line


def read(path: Path, options: ReadOptions) -> Scene:
    """Read an .obj file and its .mtl files.

    Raises:
        SceneError: a line that is not understood, a vertex that does not exist, or no faces.
    """
    tables = _parse(path)
    if tables.faults:
        n = len(tables.faults)
        text = f"{path}: {n} face{'s'[: n > 1]} of fewer than three corners left out ({', '.join(tables.faults[:3])})"
        if options.strict:
            raise SceneError(text)
        warn(text)
    if tables.free_form:
        warn(f"{path}: {tables.free_form} free-form curves and surfaces are left out; export polygons")
    finishes = _libraries(path, tables, options)
    wanted = {material for _, material in tables.groups if material}
    if missing := sorted(wanted - set(finishes)):
        warn(f"{path}: materials that no library defines: {shown(missing)}")
    vertices = np.array([row[:3] for row in tables.vertices], np.float64).reshape(-1, 3)
    colors = np.array([row[3:6] if len(row) >= 6 else [np.nan] * 3 for row in tables.vertices]).reshape(-1, 3)
    uv = np.array(tables.uv, np.float64).reshape(-1, 2)
    parts = [_part(name or path.stem, material, rows, (vertices, colors, uv), finishes.get(material))
             for (name, material), rows in tables.groups.items() if rows]  # fmt: skip
    placed = [with_means(part, part.uv is None, part.emission_uv is None) for part in parts]
    warn_of_means(parts, placed, str(path))
    return assemble(placed, str(path), options)


def _parse(path: Path) -> _Tables:
    tables = _Tables()
    name = {"o": "", "g": ""}
    material, faces = "", None
    for number, line in enumerate(read_text(path).splitlines(), 1):
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        key = words[0]
        try:
            if key == "v":
                tables.vertices.append(_floats(words[1:], 3))
            elif key == "vt":
                tables.uv.append([*_floats(words[1:], 1), 0.0][:2])
            elif key in ("f", "fo"):
                if faces is None:
                    full = "/".join(n for n in dict.fromkeys(name.values()) if n.lower() not in NO_NAME)
                    faces = tables.groups.setdefault((full, material), [])
                if len(words) < 4:
                    tables.faults.append(f"line {number}")
                else:
                    faces.append([_corner(word, tables, number) for word in words[1:]])
            elif key in ("o", "g"):
                name[key], faces = " ".join(words[1:]), None
                if key == "o":
                    name["g"] = ""
            elif key == "usemtl":
                material, faces = " ".join(words[1:]), None
            elif key == "mtllib":
                tables.libraries.append(line.split(None, 1)[1].strip() if len(words) > 1 else "")
            elif key in FREE_FORM:
                tables.free_form += 1
        except ValueError as error:
            raise SceneError(f"{path}, line {number}: '{line.strip()[:80]}' is not understood ({error})") from None
    for what, table in (("vertex", tables.vertices), ("texture vertex", tables.uv)):
        index, number = tables.highest.get(what, (0, 0))
        if index > len(table):
            raise SceneError(f"{path}, line {number}: a face names {what} {index}; there are {len(table)}")
    return tables


def _floats(words: list[str], least: int) -> list[float]:
    if len(words) < least:
        raise ValueError(f"expected {least} numbers")
    return [float(word) for word in words]


def _corner(word: str, tables: _Tables, line: int) -> tuple[int, int]:
    """Vertex and texture vertex, from 0; relative numbers count back from the last one so far."""
    parts = word.split("/")
    vertex = _index(parts[0], len(tables.vertices), "vertex", tables, line)
    return vertex, _index(parts[1], len(tables.uv), "texture vertex", tables, line) if len(parts) > 1 and parts[1] else NONE


def _index(word: str, count: int, what: str, tables: _Tables, line: int) -> int:
    index = int(word)
    if index == 0 or -index > count:
        raise ValueError(f"{what} {index} does not exist: {count} are given before this line, and numbers begin at 1")
    if index > tables.highest.get(what, (0, 0))[0]:
        tables.highest[what] = (index, line)
    return index - 1 if index > 0 else count + index


def _libraries(path: Path, tables: _Tables, options: ReadOptions) -> dict[str, Finish]:
    result: dict[str, Finish] = {}
    lost = []
    for text in dict.fromkeys(tables.libraries):
        # a name may hold blanks, and a line may hold several names
        whole = path.parent / text.replace("\\", "/")
        for file in [whole] if whole.is_file() else [path.parent / name.replace("\\", "/") for name in text.split()]:
            if file.is_file():
                result.update(read_library(file, options))
            else:
                lost.append(str(file.name))
    if lost:
        warn(f"{path}: material libraries that do not exist: {shown(lost)}; put them beside the file")
    return result


def _part(name: str, material: str, rows, tables, finish: Finish | None) -> Part:
    vertices, colors, uv = tables
    flat = np.array([corner for row in rows for corner in row], np.int64)
    faces = cut(vertices[flat[:, 0]], np.array([len(row) for row in rows]))
    corners, index = np.unique(flat, axis=0, return_inverse=True)
    numbers = np.where(faces >= 0, index.ravel()[faces], -1)
    finish = finish or Finish(Material())
    part = Part(
        f"{name}/{material}" if material and material != name else name, vertices[corners[:, 0]], numbers, finish.material
    )
    color = decode_srgb(colors[corners[:, 0]])
    if np.isfinite(color).all():
        part = replace(part, color=color)
        if finish.material.reflectance is None:
            part = replace(part, material=replace(finish.material, reflectance=(1.0,)))
    base, emissive = finish.base, finish.emissive
    part = replace(part, texture=base and base.image, emission_texture=emissive and emissive.image)
    if (corners[:, 1] >= 0).all():
        own = uv[corners[:, 1]]
        return replace(part, uv=base and base.uv(own), emission_uv=emissive and emissive.uv(own))
    return part
