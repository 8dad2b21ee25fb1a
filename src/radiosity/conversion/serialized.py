"""Mitsuba's serialized meshes, version 4: a zlib stream for each mesh, and at the end of the file where each begins."""

import struct
import zlib
from collections.abc import Iterator

import numpy as np

from ..scene.formats.mitsuba.mesh import DOUBLE, MAGIC
from .pieces import triangles

VERSION = 4


def pack(meshes: list[tuple[np.ndarray, np.ndarray]], names: list[str]) -> Iterator[bytes]:
    """Yield the parts of a file of meshes: vertices, (n, 3) metres, and faces, (k, 4), which become triangles."""
    starts, at = [], 0
    for (vertices, faces), name in zip(meshes, names, strict=True):
        halves = triangles(faces)
        corners = np.take_along_axis(faces[halves[:, 0]], halves[:, 1:], axis=1)
        head = struct.pack("<I", DOUBLE) + name.encode() + b"\0" + struct.pack("<QQ", len(vertices), len(corners))
        body = head + np.ascontiguousarray(vertices, "<f8").tobytes() + corners.astype("<u4").tobytes()
        block = struct.pack("<HH", MAGIC, VERSION) + zlib.compress(body)
        starts.append(at)
        at += len(block)
        yield block
    yield struct.pack(f"<{len(starts)}QI", *starts, len(starts))
