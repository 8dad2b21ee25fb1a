"""The bytes of a glTF file, and accessors of random kinds to them."""

import numpy as np

from .draw import Draw

KINDS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Buffer:
    """One buffer that grows."""

    def __init__(self, draw: Draw):
        self._draw = draw
        self.data = b""
        self.tree: dict = {"accessors": [], "bufferViews": []}

    def uses(self, extension: str, *, required: bool = False) -> None:
        """Notes an extension."""
        for key in ("extensionsUsed", "extensionsRequired") if required else ("extensionsUsed",):
            self.tree[key] = sorted({*self.tree.get(key, []), extension})

    def view(self, data: bytes, **more) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        self.tree["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more})
        self.data += data
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, values, dtype: str, *, bounds: bool = False, vertices: bool = True, **more) -> int:
        """An accessor of (n,) or (n, width) values; of vertices: rows begin at multiples of four bytes."""
        values = np.asarray(values).reshape(len(values), -1)
        stored = np.ascontiguousarray(values, "<" + dtype)
        width, row = stored.shape[1], stored.shape[1] * stored.itemsize
        stride = row + -row % 4 if vertices else row
        if vertices and "interleaved" in self._draw.features:
            stride += 4 * int(self._draw.integers(0, 3))
        table = np.zeros((len(stored), stride), np.uint8)
        table[:, :row] = stored.view(np.uint8).reshape(len(stored), row)
        before = b"\7" * 4 * int(self._draw.integers(0, 3)) if self._draw.random() < 0.3 else b""
        info: dict = {"bufferView": self.view(before + table.tobytes(), **({"byteStride": stride} if stride != row else {}))}
        info |= {"byteOffset": len(before)} if before else {}
        info |= {"componentType": KINDS[dtype], "count": len(stored), "type": TYPES[width], **more}
        if bounds:
            info |= {"min": stored.min(axis=0).tolist(), "max": stored.max(axis=0).tolist()}
        self.tree["accessors"].append(info)
        return len(self.tree["accessors"]) - 1

    def positions(self, points: np.ndarray, *, quantized: bool) -> int:
        if quantized:
            self.uses("KHR_mesh_quantization", required=True)
            return self.accessor(points, "i2", bounds=True)
        if "sparse" not in self._draw.features:
            return self.accessor(points, "f4", bounds=True)
        moved = np.sort(self._draw.permutation(len(points))[: max(1, len(points) // 3)])
        base = points.copy()
        base[moved] += 1
        index = self.accessor(base, "f4")
        stored = points.astype("<f4")
        self.tree["accessors"][index] |= {
            "min": stored.min(axis=0).tolist(),
            "max": stored.max(axis=0).tolist(),
            "sparse": {
                "count": len(moved),
                "indices": {"bufferView": self.view(moved.astype("<u2").tobytes()), "componentType": KINDS["u2"]},
                "values": {"bufferView": self.view(stored[moved].tobytes())},
            },
        }
        return index

    def coordinates(self, uv: np.ndarray) -> int:
        dtype = self._draw.one("f4", "f4", "u1", "u2")
        if dtype == "f4" or uv.min() < 0 or uv.max() > 1:
            return self.accessor(uv, "f4")
        self._draw.features.add("normalised coordinates")
        return self.accessor(np.round(uv * np.iinfo(dtype).max), dtype, normalized=True)

    def colors(self, count: int) -> int:
        """Linear colours of vertices: floating point or normalised, with or without alpha."""
        colors = self._draw.uniform(0.1, 0.95, (count, self._draw.one(3, 4)))
        colors[:, 3:] = 1
        dtype = self._draw.one("f4", "u1", "u2")
        if dtype == "f4":
            return self.accessor(colors, "f4")
        self._draw.features.add("normalised colours")
        return self.accessor(np.round(colors * np.iinfo(dtype).max), dtype, normalized=True)

    def indices(self, index: np.ndarray) -> int:
        return self.accessor(index, self._draw.one("u1", "u2", "u4"), vertices=False)
