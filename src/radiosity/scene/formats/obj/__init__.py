"""Wavefront OBJ: a part for every (object, group, material); quadrilaterals stay whole, backs radiate.

Read here and not through trimesh, which merges groups and takes relative vertex numbers for absolute ones. Lengths
are metres. ``Kd`` times texture times vertex colour (sRGB, as programs write it) is the reflectance, ``Ke`` a radiance.
"""

from dataclasses import replace
from os.path import isfile  # False for a name too long, where Path.is_file raises
from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...assemble import Material, Part, ReadOptions, assemble, warn
from ...model import Scene
from ...sampler import DEFAULT_SAMPLER
from ..faces import cut
from ..textures import decode_srgb, warn_of_means, with_means
from .mtl import Finish, read_library
from .tables import Tables, parse


def read(path: Path, options: ReadOptions) -> Scene:
    """Read an .obj file and its .mtl files.

    Raises:
        SceneError: a line that is not understood, a vertex that does not exist, or no faces.
    """
    tables = parse(path)
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


def _libraries(path: Path, tables: Tables, options: ReadOptions) -> dict[str, Finish]:
    result: dict[str, Finish] = {}
    lost = []
    for text in dict.fromkeys(tables.libraries):
        # a name may hold blanks, and a line may hold several names
        whole = path.parent / text.replace("\\", "/")
        for file in [whole] if isfile(whole) else [path.parent / name.replace("\\", "/") for name in text.split()]:
            options.admit(file, path)
            if isfile(file):
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
    keys, index = np.unique(flat[:, 0] * (len(uv) + 1) + flat[:, 1] + 1, return_inverse=True)
    corners = np.column_stack([keys // (len(uv) + 1), keys % (len(uv) + 1) - 1])
    numbers = np.where(faces >= 0, index[faces], -1)
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
    part = replace(
        part, texture=base and base.image, emission_texture=emissive and emissive.image,
        sampler=base.sampler if base else DEFAULT_SAMPLER, emission_sampler=emissive.sampler if emissive else DEFAULT_SAMPLER,
    )  # fmt: skip
    if (corners[:, 1] >= 0).all():
        own = uv[corners[:, 1]]
        return replace(part, uv=base and base.uv(own), emission_uv=emissive and emissive.uv(own))
    return part
