"""The document of a glTF file and its buffer, part by part."""

from dataclasses import dataclass, field

import numpy as np

FLOAT, USHORT, UINT = 5126, 5123, 5125
ARRAY, ELEMENTS = 34962, 34963
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


@dataclass(eq=False)
class Buffers:
    """Accessors, views and the bytes that they look at."""

    accessors: list[dict] = field(default_factory=list)
    views: list[dict] = field(default_factory=list)
    blocks: list[np.ndarray] = field(default_factory=list)
    length: int = 0

    def vertices(self, values: np.ndarray, *, limits: bool = False) -> int:
        """Add values of vertices, (n, k) or (n,), as 32-bit floats, and return the accessor's number."""
        data = np.ascontiguousarray(values, "<f4")
        ends = {"min": data.min(axis=0).tolist(), "max": data.max(axis=0).tolist()} if limits else {}
        return self._accessor(data, KINDS[1 if data.ndim == 1 else data.shape[1]], FLOAT, ARRAY, ends)

    def indices(self, values: np.ndarray) -> int:
        """Add numbers of vertices and return the accessor's number."""
        return self._accessor(np.ascontiguousarray(values.ravel(), "<u4"), "SCALAR", UINT, ELEMENTS, {})

    def image(self, data: bytes) -> int:
        """Add the bytes of an image file and return the view's number."""
        return self._view(np.frombuffer(data, np.uint8), {})

    def _accessor(self, data: np.ndarray, kind: str, component: int, target: int, more: dict) -> int:
        view = self._view(data.reshape(-1).view(np.uint8), {"target": target})
        self.accessors.append({"bufferView": view, "componentType": component, "count": len(data), "type": kind, **more})
        return len(self.accessors) - 1

    def _view(self, data: np.ndarray, more: dict) -> int:
        self.views.append({"buffer": 0, "byteOffset": self.length, "byteLength": len(data), **more})
        padding = np.zeros(-len(data) % 4, np.uint8)
        self.blocks += [data, padding]
        self.length += len(data) + len(padding)
        return len(self.views) - 1
