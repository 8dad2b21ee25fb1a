"""PLY: triangles with vertex colours (8 bits, sRGB) and the values themselves (32-bit floats, one property a band).

Vertices keep the scene's axes and metres, and have the number of their surface. The surfaces' names, the unit and the scale are
in comments of the header. Coordinates are 32-bit floats, or doubles where floats would lose 1e-6 of a surface's size. Unknown
values are NaN. Faces have no other properties, since some readers fail on them.
"""

import re

import numpy as np

from ..solution.replacing import replacing
from . import tone
from .look import Look
from .mesh import coloured

CHUNK = 1 << 19


def write(solution, path, look: Look) -> None:
    """Write a binary PLY file."""
    mesh = coloured(solution, look)
    bands = [mesh.key] if len(mesh.bands) == 1 else [f"{mesh.key}_{_word(band)}" for band in mesh.bands]
    far = any(part.origin.any() for part in mesh.by_surface())
    place, values = ("xyz", "<f8" if far else "<f4", 3), ("values", "<f4", mesh.values.shape[1])
    vertex = np.dtype([place, ("rgb", "u1", 3), values, ("surface", "<i4")])
    face = np.dtype([("n", "u1"), ("corners", "<i4", 3)])
    surface = np.zeros(len(mesh.vertices), np.int32)
    surface[mesh.triangles] = mesh.surface[:, None]
    header = [
        "ply",
        "format binary_little_endian 1.0",
        "comment made by radiosity; coordinates in metres",
        f"comment quantity {mesh.key} unit {mesh.unit} scale {mesh.scale!r}",
        "comment colours are sRGB of value x scale, clipped to 1",
        *(f"comment surface {i} {_line(name)}" for i, name in enumerate(mesh.names)),
        f"element vertex {len(mesh.vertices)}",
        *(f"property {'double' if far else 'float'} {axis}" for axis in "xyz"),
        *(f"property uchar {colour}" for colour in ("red", "green", "blue")),
        *(f"property float {band}" for band in bands),
        "property int surface",
        f"element face {len(mesh.triangles)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    with replacing(path) as temporary, temporary.open("wb") as file:
        file.write(("\n".join(header) + "\n").replace("²", "2").encode("ascii", "replace"))
        for begin in range(0, len(mesh.vertices), CHUNK):
            part = slice(begin, begin + CHUNK)
            rows = np.zeros(len(mesh.vertices[part]), vertex)
            rows["xyz"], rows["rgb"] = mesh.vertices[part], tone.eight_bits(tone.srgb(mesh.linear[part]))
            rows["values"], rows["surface"] = mesh.values[part], surface[part]
            file.write(rows.tobytes())
        for begin in range(0, len(mesh.triangles), CHUNK):
            part = slice(begin, begin + CHUNK)
            rows = np.zeros(len(mesh.triangles[part]), face)
            rows["n"], rows["corners"] = 3, mesh.triangles[part]
            file.write(rows.tobytes())


def _word(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "_", text)


def _line(text: str) -> str:
    return "".join(c if c.isprintable() else " " for c in text)
