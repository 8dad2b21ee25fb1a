"""Colours that meshes bring along, as Mitsuba names the attributes of PLY files, and at the corners of faces."""

from dataclasses import replace

import numpy as np

from ....errors import SceneError, shown
from .color import VertexColors
from .shapes import Geometry

POSTFIXES = ("xyzw", "rgba", "0123", "1234")
COLORS = (("r", "g", "b"), ("red", "green", "blue"))
OWN = ("x", "y", "z", "nx", "ny", "nz", "u", "v", "s", "t")


def ply_attributes(columns: dict[str, np.ndarray], kind: str) -> dict[str, np.ndarray]:
    """The attributes of an element, (n, 1 or 3) float64 each.

    ``r``, ``g``, ``b`` are ``vertex_color``; properties of one name with the postfixes of `POSTFIXES` are one attribute, and with
    ``_r``, ``_g``, ``_b`` it has ``_color`` behind its name.

    Args:
        columns: properties by name, in the file's order.
        kind: ``vertex`` or ``face``.
    """
    found: dict[str, np.ndarray] = {}
    colors = next((names for names in COLORS if set(names) <= set(columns)), ())
    if colors:
        found[f"{kind}_color"] = np.column_stack([columns[name] for name in colors]).astype(np.float64)
    groups: dict[tuple[str, str], list[str]] = {}
    for name in columns:
        stem, mark, postfix = name.rpartition("_")
        letters = next((letters for letters in POSTFIXES if mark and postfix and postfix in letters), None)
        if letters is not None and name not in (*colors, *OWN):
            known = next((other for other in POSTFIXES if (stem, other) in groups and postfix in other), letters)
            groups.setdefault((stem, known), []).append(name)
    for (stem, letters), names in groups.items():
        if len(names) in (1, 3):
            key = f"{kind}_{stem}" + ("_color" if letters == "rgba" else "")
            found[key] = np.column_stack([columns[name] for name in names]).astype(np.float64)
    return found


def with_colors(geometry: Geometry, wanted: list[VertexColors | None], place: str) -> tuple[Geometry, list[np.ndarray | None]]:
    """Colours (n_vertices, 1 or 3) of the geometry that comes back with them: its corners are vertices of their own where faces
    have colours.

    Raises:
        SceneError: the mesh has no such attribute.
    """
    for colors in wanted:
        if colors is not None and colors.name not in geometry.attributes:
            held = f"it has {shown(geometry.attributes)}" if geometry.attributes else "it has none"
            raise SceneError(f"{place}: the shape has no attribute '{colors.name}' for its colours; {held}")
    values = [None if colors is None else geometry.attributes[colors.name] * colors.scale for colors in wanted]
    if not any(colors is not None and colors.name.startswith("face_") for colors in wanted):
        return geometry, values
    used = geometry.faces >= 0
    corner, row = geometry.faces[used], np.nonzero(used)[0]
    faces = np.full(geometry.faces.shape, -1)
    faces[used] = np.arange(len(corner))
    result = [
        None if colors is None or value is None else value[row if colors.name.startswith("face_") else corner]
        for colors, value in zip(wanted, values, strict=True)
    ]
    uv = None if geometry.uv is None else geometry.uv[corner]
    return replace(geometry, vertices=geometry.vertices[corner], faces=faces, uv=uv, attributes={}), result


def mean_color(geometry: Geometry, wanted: VertexColors, place: str) -> np.ndarray:
    """Return the mean over the area of the faces, (1 or 3,)."""
    geometry, (color,) = with_colors(geometry, [wanted], place)
    assert color is not None
    corners = geometry.faces[:, [0, 1, 2, -1]]
    corners = np.where(corners < 0, corners[:, [2]], corners)
    total, weight = np.zeros(color.shape[1]), 0.0
    for half in ([0, 1, 2], [0, 2, 3]):
        a, b, c = (geometry.vertices[corners[:, i]] for i in half)
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        total += area @ color[corners[:, half]].mean(axis=1)
        weight += area.sum()
    return total / max(weight, 1e-300)
