"""Meshes that a Mitsuba scene names: OBJ, PLY and serialized files, each as one shape whatever groups it has."""

import re
import struct
import zlib
from pathlib import Path

import numpy as np

from ....errors import SceneError
from ..faces import cut, warn_of_crossing
from ..mesh.ply import read_ply
from ..mesh.ply_faces import of_polygons, polygons
from ..obj.tables import parse
from .attributes import ply_attributes
from .node import Node
from .shapes import Geometry

NORMALS, COORDINATES, COLORS, DOUBLE = 0x1, 0x2, 0x8, 0x2000  # flags of serialized files
MAGIC = 0x041C
MOST_BYTES = 1 << 31


def read_mesh(node: Node, file: Path) -> Geometry:
    """The geometry of an ``obj``, ``ply`` or ``serialized`` shape.

    Raises:
        SceneError: the file is damaged, or holds no faces.
    """
    geometry = {"obj": _obj, "ply": _ply, "serialized": _serialized}[node.plugin](node, file)
    if not len(geometry.faces):
        raise SceneError(f"{file}: the mesh holds no faces")
    uv = geometry.uv
    if uv is not None and node.values.get("flip_tex_coords", node.plugin == "obj"):
        uv = np.column_stack([uv[:, 0], 1 - uv[:, 1]])
    own_normals = geometry.own_normals and not node.values.get("face_normals", False)
    return Geometry(geometry.vertices, geometry.faces, uv, geometry.attributes, own_normals)


def _obj(node: Node, file: Path) -> Geometry:
    tables = parse(file)
    rows = [row for group in tables.groups.values() for row in group]
    if not rows:
        return Geometry(np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    points = np.array([row[:3] for row in tables.vertices], float).reshape(-1, 3)
    corners, index = np.unique([corner for row in rows for corner in row], axis=0, return_inverse=True)
    vertices = points[corners[:, 0]]
    index = index.ravel()
    crossed: list[int] = []
    faces = cut(vertices[index], np.array([len(row) for row in rows]), crossed)
    warn_of_crossing(file, {file.stem: crossed})
    has_uv = (corners[:, 1] >= 0).all()
    uv = np.array(tables.uv, float).reshape(-1, 2)[corners[:, 1]] if has_uv else None
    normals = re.search(rb"(?m)^\s*vn\s", file.read_bytes()) is not None
    return Geometry(vertices, np.where(faces >= 0, index[faces], -1), uv, own_normals=normals)


def _ply(node: Node, file: Path) -> Geometry:
    ply = read_ply(file)
    index = polygons(file, ply)
    if "vertex" not in ply.columns or index is None:
        raise SceneError(f"{file}: the file has no vertices or no faces")
    vertex = ply.columns["vertex"].numbers
    if not {"x", "y", "z"} <= set(vertex):
        raise SceneError(f"{file}: the vertices have no x, y, z")
    points = _columns(vertex, ("x", "y", "z"))
    corners = _checked(index.values, len(points), file)
    crossed: list[int] = []
    faces = cut(points[corners], index.sizes, crossed)
    warn_of_crossing(file, {file.stem: crossed})
    uv = next((_columns(vertex, pair) for pair in (("u", "v"), ("s", "t")) if set(pair) <= set(vertex)), None)
    polygon = np.repeat(np.arange(len(index.sizes)), index.sizes)[faces[:, 0]]
    face = of_polygons(ply, index)
    of_faces = ply_attributes(face.numbers, "face")
    attributes = ply_attributes(vertex, "vertex") | {name: values[polygon] for name, values in of_faces.items()}
    return Geometry(points, np.where(faces >= 0, corners[faces], -1), uv, attributes, {"nx", "ny", "nz"} <= set(vertex))


def _columns(columns: dict, names: tuple[str, ...]) -> np.ndarray:
    return np.column_stack([np.asarray(columns[name], np.float64) for name in names])


def _checked(index: np.ndarray, count: int, file: Path) -> np.ndarray:
    wrong = (index < 0) | (index >= count)
    if wrong.any():
        raise SceneError(f"{file}: a face names vertex {int(index[wrong][0])}; there are {count} (0 to {count - 1})")
    return index


def _serialized(node: Node, file: Path) -> Geometry:
    """Mitsuba's own format: a zlib stream for each shape, and at the end of the file where each begins."""
    data = file.read_bytes()
    number = int(node.number("shape_index", 0))
    try:
        (count,) = struct.unpack_from("<I", data, len(data) - 4)
        version = struct.unpack_from("<HH", data)
        if version[0] != MAGIC or version[1] not in (3, 4):
            raise SceneError(f"{file}: is no serialized mesh of version 3 or 4")
        if not 0 <= number < count:
            raise SceneError(f"{node.place}: shape_index is {number}; '{file.name}' holds {count} shapes")
        size, kind = (8, "<Q") if version[1] == 4 else (4, "<I")
        (start,) = struct.unpack_from(kind, data, len(data) - 4 - size * (count - number))
        stream = zlib.decompressobj().decompress(data[start + 4 :], MOST_BYTES)
        return _unpacked(stream, version[1], file)
    except (struct.error, zlib.error, ValueError, OverflowError, MemoryError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError(f"{file}: the serialized mesh is damaged or truncated ({error})") from None


def _unpacked(stream: bytes, version: int, file: Path) -> Geometry:
    (flags,) = struct.unpack_from("<I", stream)
    at = stream.index(b"\0", 4) + 1 if version == 4 else 4
    n_vertices, n_faces = struct.unpack_from("<QQ", stream, at)
    at += 16
    real = np.dtype("<f8" if flags & DOUBLE else "<f4")

    def take(count: int, width: int, dtype) -> np.ndarray:
        nonlocal at
        table = np.frombuffer(stream, dtype, count * width, at).reshape(count, width)
        at += table.nbytes
        return table

    points = take(n_vertices, 3, real).astype(np.float64)
    if flags & NORMALS:
        take(n_vertices, 3, real)
    uv = take(n_vertices, 2, real).astype(np.float64) if flags & COORDINATES else None
    color = take(n_vertices, 3, real).astype(np.float64) if flags & COLORS else None
    faces = take(n_faces, 3, np.dtype("<u4" if n_vertices <= 0xFFFFFFFF else "<u8")).astype(np.int64)
    attributes = {} if color is None else {"vertex_color": color}
    return Geometry(points, _checked(faces, n_vertices, file), uv, attributes, bool(flags & NORMALS))
