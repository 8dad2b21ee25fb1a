"""STL files with random features."""

import struct
from pathlib import Path

import numpy as np

from .draw import Draw, Sample, Shape


def write(folder: Path, seed: int) -> Sample:
    draw = Draw("stl", seed)
    path = folder / f"{seed}.stl"
    if draw.has("binary", 0.5):
        shapes = [draw.shape().moved(draw.matrix()) for _ in range(int(draw.integers(1, 4)))]
        path.write_bytes(_binary(draw, np.concatenate([_corners(shape) for shape in shapes])))
    else:
        path.write_bytes(_text(draw).encode())
    return Sample(path, "stl", draw.features)


def _corners(shape: Shape) -> np.ndarray:
    return shape.points[shape.triangles()]


def _normals(draw: Draw, corners: np.ndarray) -> np.ndarray:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.zeros_like(normals) if draw.has("no normals", 0.3) else normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _binary(draw: Draw, corners: np.ndarray) -> bytes:
    head = b"solid made at random" if draw.has("binary that begins with solid", 0.3) else b"made at random"
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    table = np.zeros(len(corners), row)
    table["normal"], table["corners"] = _normals(draw, corners), corners
    if draw.has("attribute bytes", 0.3):
        table["attribute"] = draw.integers(0, 2**15, len(corners))
    more = bytes(draw.integers(0, 255, 37, np.uint8)) if draw.has("trailing bytes", 0.15) else b""
    return head.ljust(80, draw.one(b"\0", b" ")) + struct.pack("<I", len(corners)) + table.tobytes() + more


def _text(draw: Draw) -> str:
    lines = []
    count = int(draw.integers(1, 4)) if draw.has("several solids", 0.5) else 1
    upper = draw.has("upper case", 0.2)
    indented = draw.has("indented", 0.6)
    number = draw.one("{:.9g}".format, "{:.8e}".format)
    unnamed = count == 1 and draw.has("unnamed", 0.2)
    for solid in range(count):
        name = "" if unnamed else draw.one(f"part{solid}", f"part of {solid}", f"P_{solid}")
        if " " in name:
            draw.features.add("names with blanks")
        corners = _corners(draw.shape().moved(draw.matrix()))
        lines.append(f"solid {name}".rstrip())
        for normal, triangle in zip(_normals(draw, corners), corners, strict=True):
            lines += [" facet normal " + " ".join(map(number, normal)), "  outer loop"]
            lines += ["   vertex " + " ".join(map(number, corner)) for corner in triangle]
            lines += ["  endloop", " endfacet"]
        lines.append(f"endsolid {name}".rstrip())
    if not indented:
        lines = [line.strip() for line in lines]
    if upper:
        lines = [_upper(line) for line in lines]
    return (draw.one("\n", "\r\n") if draw.has("crlf or not", 0.3) else "\n").join(lines) + "\n"


def _upper(line: str) -> str:
    """Keywords in capitals, names as they are."""
    words = line.split(" ")
    return " ".join(word.upper() if word.lower() in KEYWORDS else word for word in words)


KEYWORDS = ("solid", "endsolid", "facet", "normal", "outer", "loop", "vertex", "endloop", "endfacet")
