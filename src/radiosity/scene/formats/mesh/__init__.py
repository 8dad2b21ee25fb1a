"""PLY and STL: shapes without materials, backs radiate, lengths are metres. For emission and names use a .toml file.

PLY vertex and face colours are the reflectance: whole numbers (0 to 255) are sRGB, as programs write them, floating
point numbers linear. A texture named in a ``TextureFile`` comment is used where there are coordinates for it.
"""

import logging
import re
import warnings
from pathlib import Path

import numpy as np

from ....errors import SceneError
from ...assemble import Material, Part, ReadOptions, assemble, warn
from ...model import Scene
from ..faces import cut
from ..textures import decode_srgb, warn_of_means, with_means
from .ply import read_ply
from .ply_rows import Columns
from .ply_textures import NONE, of_corners, of_faces, of_vertices, textures

INDICES = ("vertex_indices", "vertex_index")


def read(path: Path, options: ReadOptions) -> Scene:
    """Read a .ply or .stl file.

    Raises:
        SceneError: damaged, truncated, or without faces.
    """
    parts = _stl(path) if path.suffix.lower() == ".stl" else _ply(path, options)
    placed = [with_means(part, part.uv is None, False) for part in parts]
    warn_of_means(parts, placed, str(path))
    return assemble(placed, str(path), options)


def _stl(path: Path) -> list[Part]:
    """A part for every solid of an ASCII file; a binary file is one."""
    import trimesh.exchange.stl as stl

    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little") if len(data) >= 84 else -1
    binary = count >= 0 and len(data) == 84 + 50 * count
    head = data[:4096].lower()
    if not binary and not (head.lstrip().startswith(b"solid") and (b"facet" in head or b"endsolid" in head)):
        announced = f"its header announces {count} triangles ({84 + 50 * count} bytes), it has {len(data)} bytes"
        raise SceneError(f"{path}: {announced if count >= 0 else 'too short'}; the STL file is truncated or damaged")
    log, level = logging.getLogger("trimesh"), logging.getLogger("trimesh").level
    log.setLevel(logging.CRITICAL)  # it prints the traces of what it survives
    try:
        with path.open("rb") as file, warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # numpy's, where text is no number
            found = stl.load_stl_binary(file) if binary else stl.load_stl_ascii(file)
    except Exception as error:  # trimesh lets its own parts' exceptions through
        raise SceneError(f"{path}: cannot be read as STL ({error}); the file is damaged") from None
    finally:
        log.setLevel(level)
    solids = {found["metadata"].get("name") or path.stem: found} if "vertices" in found else found.get("geometry", {})
    if not binary:
        expected, got = data.lower().count(b"endfacet"), sum(len(solid["faces"]) for solid in solids.values())
        if got < expected or data.lower().count(b"facet normal") > expected:
            raise SceneError(
                f"{path}: {got} of {data.lower().count(b'facet normal')} facets are complete; the file is truncated or damaged"
            )
    # trimesh calls a solid without a name geometry_1, ...
    names = [path.stem if binary or re.fullmatch(r"geometry_\d+", str(name)) else str(name) for name in solids]
    return [Part(name, solid["vertices"], solid["faces"]) for name, solid in zip(names, solids.values(), strict=True)]


def _ply(path: Path, options: ReadOptions) -> list[Part]:
    ply = read_ply(path)
    vertex, face = ply.columns.get("vertex", Columns({}, {})), ply.columns.get("face", Columns({}, {}))
    if not set("xyz") <= set(vertex.numbers):
        raise SceneError(f"{path}: the vertices have no x, y, z; the file is damaged")
    points = np.column_stack([vertex.numbers[axis] for axis in "xyz"]).astype(np.float64)
    polygons = next((face.lists[name] for name in INDICES if name in face.lists), None)
    if polygons is None or not len(polygons.sizes):
        raise SceneError(f"{path}: the file holds {len(points)} points but no faces; export a surface, not a point cloud")
    index = polygons.values.astype(np.int64)
    wrong = (index < 0) | (index >= len(points))
    if wrong.any():
        at = int(np.flatnonzero(wrong)[0])
        row = int(np.searchsorted(np.cumsum(polygons.sizes), at, side="right"))
        raise SceneError(f"{path}: face {row} names vertex {index[at]}; there are {len(points)} (0 to {len(points) - 1})")
    if (polygons.sizes < 3).any():
        text = f"{path}: {int((polygons.sizes < 3).sum())} faces of fewer than three corners left out"
        if options.strict:
            raise SceneError(text)
        warn(text)
    faces = cut(points[index], polygons.sizes)
    polygon = np.repeat(np.arange(len(polygons.sizes)), polygons.sizes)[faces[:, 0]]
    color, face_color, uv = _color(path, vertex), _color(path, face), of_vertices(vertex)
    wedges, placed = of_corners(path, face.lists.get("texcoord"), polygons.sizes)
    if wedges is not None:
        uv = wedges
        points, color = points[index], None if color is None else color[index]
    elif face_color is not None and color is None:
        points, uv = points[index], None if uv is None else uv[index]
    else:
        faces = np.where(faces >= 0, index[faces], -1)  # every corner need not be a vertex of its own
    if face_color is not None and color is None:
        color = np.repeat(face_color, polygons.sizes, axis=0)
    images = textures(path, ply, options)
    number = of_faces(path, face, len(polygons.sizes), len(images))
    if wedges is not None:
        number = np.where(placed, number, NONE)
    parts = []
    for which in np.unique(number[polygon]):
        image = None if which == NONE else images[which]
        material = Material() if color is None and image is None else Material((1.0,))
        parts.append(Part(path.stem, points, faces[number[polygon] == which], material, uv, color, image))
    return parts


def _color(path: Path, columns: Columns) -> np.ndarray | None:
    """(n, 3) linear colours of an element."""
    found = [columns.numbers[name] for name in ("red", "green", "blue") if name in columns.numbers]
    if len(found) < 3:
        return None
    color = np.column_stack(found)
    if color.dtype.kind == "f":
        return color.astype(np.float64)
    largest = max(np.iinfo(column.dtype).max for column in found)
    if largest > 65535:
        largest = 255
    if color.min(initial=0) < 0 or color.max(initial=0) > largest:
        raise SceneError(f"{path}: colours reach from {color.min()} to {color.max()}; expected 0 to {largest}")
    return decode_srgb(color / largest)
