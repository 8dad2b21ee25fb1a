"""GLB files: JSON and one buffer (Khronos glTF 2.0)."""

import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..errors import OutputError
from ..solution.replacing import replacing

FLOAT, USHORT, UINT = 5126, 5123, 5125
ARRAY, ELEMENTS = 34962, 34963
KINDS = {2: "VEC2", 3: "VEC3", 4: "VEC4"}  # by numbers a vertex
TURN = [-np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]  # quaternion: z up to y up


@dataclass(eq=False)
class Buffer:
    """The buffer of a file, and what says where things lie in it.

    Attributes:
        views, accessors: of the document.
        blocks: the parts in order, uint8.
        length: bytes.
    """

    views: list[dict] = field(default_factory=list)
    accessors: list[dict] = field(default_factory=list)
    blocks: list = field(default_factory=list)
    length: int = 0

    def add(self, array: np.ndarray, kind: str, component: int, target: int, **more) -> int:
        """Add an array, and return the number of its accessor."""
        data = np.ascontiguousarray(array)
        view = self.view(data.reshape(-1).view(np.uint8), target=target)
        self.accessors.append({"bufferView": view, "componentType": component, "count": len(data), "type": kind, **more})
        return len(self.accessors) - 1

    def vertices(self, values: np.ndarray, *, limits: bool = False) -> int:
        """Add values of vertices, (n, k) or (n,), as 32-bit floats, and return the number of their accessor."""
        data = np.ascontiguousarray(values, "<f4")
        ends = {"min": data.min(axis=0).tolist(), "max": data.max(axis=0).tolist()} if limits else {}
        return self.add(data, "SCALAR" if data.ndim == 1 else KINDS[data.shape[1]], FLOAT, ARRAY, **ends)

    def indices(self, values: np.ndarray) -> int:
        """Add numbers of vertices, of any shape, and return the number of their accessor."""
        return self.add(np.ascontiguousarray(values, "<u4").ravel(), "SCALAR", UINT, ELEMENTS)

    def view(self, data: np.ndarray, **more) -> int:
        """Add bytes, (n,) uint8, and return the number of their view."""
        self.views.append({"buffer": 0, "byteOffset": self.length, "byteLength": len(data), **more})
        self.blocks.append(np.pad(data, (0, -len(data) % 4)) if len(data) % 4 else data)
        self.length += len(data) + -len(data) % 4
        return len(self.views) - 1

    def entries(self) -> dict:
        """Return the document's entries."""
        return {"accessors": self.accessors, "bufferViews": self.views, "buffers": [{"byteLength": self.length}]}


def save(path, contents: dict, blocks: list) -> None:
    """Write a file.

    Raises:
        OutputError: it cannot be written, or would pass the 4 GB that GLB can hold.
    """
    text = json.dumps(contents, separators=(",", ":"))
    size = sum(len(block) for block in blocks)
    if 12 + 8 + len(text.encode()) + 3 + 8 + size >= 2**32:
        raise OutputError(
            f"{path}: the mesh needs {size / 1e9:.1f} GB, and a GLB file holds 4; export smoothed values or larger patches"
        )
    with replacing(path) as temporary, temporary.open("wb") as file:
        for part in packed(text, blocks):
            file.write(part)


def packed(text: str, blocks: list) -> Iterator[Any]:
    """Yield the parts of a GLB file: its head, the JSON document, and the buffer's blocks."""
    document = text.encode()
    document += b" " * (-len(document) % 4)
    size = sum(len(block) for block in blocks)
    yield struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(document) + 8 + size)
    yield struct.pack("<I4s", len(document), b"JSON") + document
    yield struct.pack("<I4s", size, b"BIN\0")
    yield from blocks
