"""The polygons of a PLY file: lists of vertex numbers, or strips of triangles."""

from pathlib import Path

import numpy as np

from ....errors import SceneError
from ...assemble import warn
from .ply import Ply
from .ply_rows import Columns, Lists

INDICES = ("vertex_indices", "vertex_index")
AGAIN = -1  # in a strip: another one begins


def polygons(path: Path, ply: Ply) -> Lists | None:
    """Vertex numbers of each polygon, or None where the file has none.

    Raises:
        SceneError: numbers that are not whole.
    """
    faces, strips = (_indices(path, ply.columns.get(name)) for name in ("face", "tristrips"))
    if faces is None or not len(faces.sizes):
        return _triangles(strips) if strips is not None else faces
    if strips is not None and len(strips.sizes):
        warn(f"{path}: strips of triangles beside faces are left out: {len(strips.sizes)}")
    return faces


def of_polygons(ply: Ply, polygons: Lists) -> Columns:
    """The columns that have a row for each polygon; those of faces do not where the polygons come from strips."""
    face = ply.columns.get("face", Columns({}, {}))
    rows = {len(column) for column in face.numbers.values()} | {len(lists.sizes) for lists in face.lists.values()}
    return face if rows <= {len(polygons.sizes)} else Columns({}, {})


def _indices(path: Path, element: Columns | None) -> Lists | None:
    found = next((element.lists[name] for name in INDICES if element and name in element.lists), None)
    if found is None:
        return None
    if found.values.dtype.kind != "f" and found.values.dtype.itemsize <= 4:
        return Lists(found.values if found.values.dtype.kind == "i" else found.values.astype(np.int64), found.sizes)
    whole = found.values.astype(np.int64)
    if (whole != found.values).any():
        raise SceneError(f"{path}: a face names vertex {found.values[whole != found.values][0]:g}; expected whole numbers")
    return Lists(whole, found.sizes)


def _triangles(strips: Lists) -> Lists:
    """The triangles of a strip. Every second one turns the other way round; those with a corner twice only lead on."""
    index, size = strips.values, len(strips.values)
    begins = np.zeros(size + 1, bool)
    begins[np.cumsum(strips.sizes)] = True
    begins[1:] |= index == AGAIN
    begins[0] = True
    start = np.maximum.accumulate(np.where(begins[:-1], np.arange(size), 0))  # of the strip that each entry is in
    first = np.arange(max(size - 2, 0))
    corners = np.stack([index[:-2], index[1:-1], index[2:]], axis=1) if size > 2 else np.zeros((0, 3), np.int64)
    inside = (start[2:] <= first) & (corners != AGAIN).all(axis=1) if size > 2 else np.zeros(0, bool)
    one, two, three = corners.T
    inside &= (one != two) & (two != three) & (one != three)
    odd = (first - start[2:]) % 2 == 1 if size > 2 else np.zeros(0, bool)
    corners[odd] = corners[odd][:, [1, 0, 2]]
    kept = corners[inside]
    return Lists(kept.ravel(), np.full(len(kept), 3))
