"""PLY files with random features."""

import struct
from pathlib import Path

import numpy as np

from .draw import Draw, Sample, Shape, star
from .images import save_png

COUNTS = {"uchar": "B", "uint8": "B", "ushort": "H", "int": "i", "uint32": "I"}
INDICES = {"int": "i", "uint": "I", "int32": "i", "uint32": "I", "short": "h", "uint16": "H", "uchar": "B"}
REALS = {"float": "f", "double": "d", "float32": "f", "float64": "d"}


def write(folder: Path, seed: int) -> Sample:
    draw = Draw("ply", seed)
    kind = draw.one("ascii", "binary_little_endian", "binary_big_endian")
    draw.features.add(kind)
    shape = star(draw) if draw.has("concave polygon", 0.1) else draw.shape()
    shape = shape.moved(draw.matrix())
    if draw.random() < 0.6:
        shape = Shape(shape.points, shape.triangles().tolist(), shape.uv)
    if any(len(p) > 3 for p in shape.polygons):
        draw.features.add("polygons")
    real = draw.one(*REALS)
    vertex = _vertex_columns(draw, shape, real)
    face_columns = _face_columns(draw, len(shape.polygons), vertex)
    _note_pairs(draw.features, {len(p) for p in shape.polygons})
    count, index = draw.one(*COUNTS), draw.one(*INDICES)
    comments = []
    if draw.has("comments"):
        comments = ["comment made at random", "comment"]
    if draw.has("obj_info", 0.15):
        comments.append("obj_info num_cols 3")
    if {"u", "s", "texture_u"} & {name for name, _, _ in vertex} and draw.has("texture", 0.5):
        draw.features |= {"texture and colours"} if draw.features & {"vertex colours", "face colours"} else set()
        save_png(folder / f"{seed}.png", draw.image())
        comments.append(f"comment TextureFile {seed}.png")
    before, after = draw.has("element before", 0.2), draw.has("element after", 0.2)
    head = ["ply", f"format {kind} 1.0", *comments]
    lists = before and draw.has("lists before", 0.5)
    if before:
        head += ["element stamp 2", "property uchar flag", *(["property list uchar float values"] if lists else [])]
    head += [f"element vertex {len(shape.points)}", *(f"property {t} {name}" for name, t, _ in vertex)]
    head += [f"element face {len(shape.polygons)}"]
    list_first = draw.random() < 0.5
    index_line = f"property list {count} {index} {draw.one('vertex_indices', 'vertex_index')}"
    others = [f"property {t} {name}" for name, t, _ in face_columns]
    head += [index_line, *others] if list_first else [*others, index_line]
    if after:
        head += ["element edge 1", "property int vertex1", "property int vertex2"]
    rows: list[list[tuple[str, object]]] = []
    if before:
        rows += [[("B", 1), ("B", 2), ("f", 0.5), ("f", 1.5)], [("B", 0), ("B", 0)]] if lists else [[("B", 1)], [("B", 0)]]
    codes = {**REALS, "uchar": "B", "int": "i", "ushort": "H"}
    for number in range(len(shape.points)):
        rows.append([(codes[t], values[number]) for _, t, values in vertex])
    for number, polygon in enumerate(shape.polygons):
        corners = [(COUNTS[count], len(polygon)), *((INDICES[index], corner) for corner in polygon)]
        more = [(codes[t], values[number]) for _, t, values in face_columns]
        rows.append(corners + more if list_first else more + corners)
    if after:
        rows.append([("i", 0), ("i", 1)])
    path = folder / f"{seed}.ply"
    path.write_bytes(_encoded(head, rows, kind, crlf=draw.has("crlf", 0.2) if kind == "ascii" else False))
    return Sample(path, "ply", draw.features)


def _note_pairs(features: set[str], sizes: set[int]) -> None:
    """Features that matter together."""
    if features & {"vertex colours"} and max(sizes) > 3:
        features.add("coloured polygons")
    if features & {"face colours"} and max(sizes) > 3:
        features.add("polygons with face colours")
    if len(sizes) > 1 and "ascii" not in features:
        features.add("binary, polygons of several sizes")


def _vertex_columns(draw: Draw, shape, real: str) -> list[tuple[str, str, np.ndarray]]:
    columns = [(axis, real, shape.points[:, i]) for i, axis in enumerate("xyz")]
    n = len(shape.points)
    if draw.has("normals"):
        columns += [(f"n{axis}", "float", draw.normal(size=n)) for axis in "xyz"]
    if draw.has("vertex colours", 0.35):
        names = ("red", "green", "blue", "alpha") if draw.has("alpha", 0.3) else ("red", "green", "blue")
        columns += [(name, "uchar", draw.integers(10, 240, n)) for name in names]
    if draw.has("coordinates"):
        pair = draw.one(("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
        columns += [(name, "float", shape.uv[:, i]) for i, name in enumerate(pair)]
    if draw.has("other vertex property", 0.2):
        columns.insert(0 if draw.random() < 0.3 else len(columns), ("quality", "float", draw.random(n)))
    return columns


def _face_columns(draw: Draw, n: int, vertex) -> list[tuple[str, str, np.ndarray]]:
    columns = []
    if "red" not in [name for name, _, _ in vertex] and draw.has("face colours"):
        columns += [(name, "uchar", draw.integers(10, 240, n)) for name in ("red", "green", "blue")]
    if draw.has("other face property", 0.2):
        columns.append(("flags", "int", draw.integers(0, 9, n)))
    return columns


def _encoded(head: list[str], rows, kind: str, crlf: bool) -> bytes:
    end = "\r\n" if crlf else "\n"
    text = end.join([*head, "end_header"]) + end
    if kind == "ascii":
        text += end.join(" ".join(_word(code, value) for code, value in row) for row in rows) + end
        return text.encode()
    order = "<" if kind == "binary_little_endian" else ">"
    return text.encode() + b"".join(
        struct.pack(order + "".join(code for code, _ in row), *(value if code in "fd" else int(value) for code, value in row))
        for row in rows
    )


def _word(code: str, value) -> str:
    return repr(float(value)) if code in "fd" else str(int(value))
