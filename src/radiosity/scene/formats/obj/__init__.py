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
from ..beside import in_any_case, warn_of_case
from ..faces import cut, warn_of_crossing
from ..textures import decode_srgb, warn_of_means, with_means
from ..units import warn_of_unit
from .mtl import Finish, read_library
from .tables import NO_NAME, Tables, parse
from .vertex_colors import colors_of


def read(path: Path, options: ReadOptions) -> Scene:
    """Read an .obj file and its .mtl files.

    Raises:
        SceneError: a line that is not understood, a vertex that does not exist, or no faces.
    """
    tables = parse(path)
    warn_of_unit(path, tables.comments, options)
    if tables.faults:
        n = len(tables.faults)
        text = f"{path}: {n} face{'s'[: n > 1]} of fewer than three corners left out ({', '.join(tables.faults[:3])})"
        if options.strict:
            raise SceneError(text)
        warn(text)
    if tables.free_form:
        warn(f"{path}: {tables.free_form} free-form curves and surfaces are left out; export polygons")
    if tables.left_out:
        warn(f"{path}: statements that are left out: {shown(f'{what} ({count})' for what, count in tables.left_out.items())}")
    if several := [f"{name} ({count})" for name, count in tables.begun.items() if count > 1 and name.lower() not in NO_NAME]:
        warn(f"{path}: objects of the same name become one: {shown(several)}")
    finishes = _libraries(path, tables, options)
    wanted = {material for _, material in tables.groups if material}
    if missing := sorted(wanted - set(finishes)):
        warn(f"{path}: materials that no library defines: {shown(missing)}")
    vertices = np.array([row[:3] for row in tables.vertices], np.float64).reshape(-1, 3)
    colors = colors_of(path, tables.vertices)
    uv = np.array(tables.uv, np.float64).reshape(-1, 2)
    crossed: dict[str, list[int]] = {}
    partly: list[str] = []
    parts = [
        _part(name or path.stem, material, rows, (vertices, colors, uv), finishes.get(material), crossed, partly)
        for (name, material), rows in tables.groups.items()
        if rows
    ]
    warn_of_crossing(path, crossed)
    if partly:
        text = "vertex colours are left out where some vertices of a surface have none"
        warn(f"{path}: {text}: {shown(dict.fromkeys(partly))}")
    placed = [with_means(part, part.uv is None, part.emission_uv is None) for part in parts]
    warn_of_means(parts, placed, str(path))
    return assemble(placed, str(path), options)


def _libraries(path: Path, tables: Tables, options: ReadOptions) -> dict[str, Finish]:
    result: dict[str, Finish] = {}
    lost, renamed, again = [], [], []
    for text in dict.fromkeys(tables.libraries):
        text = text.replace("\\", "/")
        # a name may hold blanks, and a line may hold several names
        whole = isfile(path.parent / text) or in_any_case(path.parent, text)
        for name in [text] if whole else text.split():
            file = options.admit(path.parent / name, path)
            if not isfile(file) and (other := in_any_case(path.parent, name)):
                renamed.append((name, other))
                file = options.admit(other, path)
            if isfile(file):
                found = read_library(file, options, tables.codec)
                again += [material for material in found if material in result]
                result.update(found)
            else:
                lost.append(file.name)
    warn_of_case(path, renamed)
    if again:
        warn(f"{path}: materials that several libraries define; the last one holds: {shown(dict.fromkeys(again))}")
    if lost:
        warn(f"{path}: material libraries that do not exist: {shown(lost)}; put them beside the file")
    return result


def _part(
    name: str, material: str, rows, tables, finish: Finish | None, crossed: dict[str, list[int]], partly: list[str]
) -> Part:
    name = f"{name}/{material}" if material and material != name else name
    vertices, colors, uv = tables
    flat = np.array([corner for row in rows for corner in row], np.int64)
    faces = cut(vertices[flat[:, 0]], np.array([len(row) for row in rows]), crossed.setdefault(name, []))
    keys, index = np.unique(flat[:, 0] * (len(uv) + 1) + flat[:, 1] + 1, return_inverse=True)
    corners = np.column_stack([keys // (len(uv) + 1), keys % (len(uv) + 1) - 1])
    numbers = np.where(faces >= 0, index[faces], -1)
    finish = finish or Finish(Material())
    base, emissive = finish.base, finish.emissive
    part = Part(
        name,
        vertices[corners[:, 0]],
        numbers,
        finish.material,
        texture=base and base.image,
        emission_texture=emissive and emissive.image,
        sampler=base.sampler if base else DEFAULT_SAMPLER,
        emission_sampler=emissive.sampler if emissive else DEFAULT_SAMPLER,
    )
    color = decode_srgb(colors[corners[:, 0]])
    if np.isfinite(color).all():
        part = replace(part, color=color)
        if finish.material.reflectance is None:
            part = replace(part, material=replace(finish.material, reflectance=(1.0,)))
    elif np.isfinite(color).any():
        partly.append(name)
    if (corners[:, 1] >= 0).all():
        own = uv[corners[:, 1]]
        return replace(part, uv=base and base.uv(own), emission_uv=emissive and emissive.uv(own))
    return part
