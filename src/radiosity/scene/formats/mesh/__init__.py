"""PLY and STL: shapes without materials, backs radiate, lengths are metres. For emission and names use a .toml file.

PLY vertex and face colours are the reflectance: whole numbers (0 to 255) are sRGB, as programs write them, floating
point numbers linear. A texture named in a ``TextureFile`` comment is used where there are coordinates for it.
"""

from pathlib import Path

import numpy as np

from ....errors import SceneError
from ...assemble import Material, Part, ReadOptions, assemble, warn
from ...model import Scene
from ..faces import cut, warn_of_crossing
from ..textures import warn_of_means, with_means
from ..units import warn_of_unit
from .ply import read_ply
from .ply_colors import colors_of
from .ply_faces import of_polygons
from .ply_faces import polygons as polygons_of
from .ply_rows import Columns
from .ply_textures import NONE, of_corners, of_faces, of_vertices, textures
from .stl import HEADER, read_stl


def read(path: Path, options: ReadOptions) -> Scene:
    """Read a .ply or .stl file.

    Raises:
        SceneError: damaged, truncated, or without faces.
    """
    parts = _stl(path, options) if path.suffix.lower() == ".stl" else _ply(path, options)
    placed = [with_means(part, part.uv is None, False) for part in parts]
    warn_of_means(parts, placed, str(path))
    return assemble(placed, str(path), options)


def _stl(path: Path, options: ReadOptions) -> list[Part]:
    parts = read_stl(path)
    with path.open("rb") as file:
        first = file.read(HEADER).decode("latin-1").split("\n", 1)[0]
    warn_of_unit(path, [first], options)
    return parts


def _ply(path: Path, options: ReadOptions) -> list[Part]:
    ply = read_ply(path)
    warn_of_unit(path, ply.comments, options)
    vertex = ply.columns.get("vertex", Columns({}, {}))
    if not set("xyz") <= set(vertex.numbers):
        raise SceneError(f"{path}: the vertices have no x, y, z; the file is damaged")
    points = np.empty((len(vertex.numbers["x"]), 3))
    for axis, name in enumerate("xyz"):
        points[:, axis] = vertex.numbers[name]
    polygons = polygons_of(path, ply)
    if polygons is None or not len(polygons.sizes):
        raise SceneError(f"{path}: the file holds {len(points)} points but no faces; export a surface, not a point cloud")
    face, index = of_polygons(ply, polygons), polygons.values
    if len(index) and not 0 <= index.min() <= index.max() < len(points):
        at = int(np.flatnonzero((index < 0) | (index >= len(points)))[0])
        row = int(np.searchsorted(np.cumsum(polygons.sizes), at, side="right"))
        raise SceneError(f"{path}: face {row} names vertex {index[at]}; there are {len(points)} (0 to {len(points) - 1})")
    if (polygons.sizes < 3).any():
        text = f"{path}: {int((polygons.sizes < 3).sum())} faces of fewer than three corners left out"
        if options.strict:
            raise SceneError(text)
        warn(text)
    crossed: list[int] = []
    size = int(polygons.sizes[0]) if polygons.sizes[0] in (3, 4) and (polygons.sizes == polygons.sizes[0]).all() else 0
    faces = np.arange(0) if size else cut(points[index], polygons.sizes, crossed)  # numbers of corners
    warn_of_crossing(path, {path.stem: crossed})
    polygon = slice(None) if size else np.repeat(np.arange(len(polygons.sizes)), polygons.sizes)[faces[:, 0]]
    color, face_color, uv = colors_of(path, vertex, "vertex"), colors_of(path, face, "face"), of_vertices(vertex)
    if color is not None and face_color is not None:
        warn(f"{path}: colours of faces are left out, since vertices have colours too")
    own = True  # corners are vertices of their own
    wedges, placed = of_corners(path, face.lists.get("texcoord"), polygons.sizes)
    if wedges is not None:
        uv = wedges
        points, color = points[index], None if color is None else color[index]
    elif face_color is not None and color is None:
        points, uv = points[index], None if uv is None else uv[index]
    else:
        own = False
    if size:
        faces = (np.arange(len(index)) if own else index).reshape(-1, size)
    elif not own:
        faces = np.where(faces >= 0, index[faces], -1)
    if face_color is not None and color is None:
        color = np.repeat(face_color, polygons.sizes, axis=0)
    images = textures(path, ply, options)
    number = of_faces(path, face, len(polygons.sizes), len(images))
    if wedges is not None:
        number = np.where(placed, number, NONE)
    parts = []
    number = number[polygon]
    several = number[:1] if (number == number[:1]).all() else np.unique(number)
    for which in several:
        image = None if which == NONE else images[which]
        material = Material() if color is None and image is None else Material((1.0,))
        some = faces[number == which] if len(several) > 1 else faces
        parts.append(Part(path.stem, points, some, material, uv, color, image))
    return parts
