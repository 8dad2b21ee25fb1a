"""STL files as triangles, binary or ASCII.

Read here and not through trimesh, which refuses bytes after the last triangle and renames solids of equal names.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...assemble import Part, warn
from ..encoding import decode
from ..names import numbered, repeated
from .stl_normals import normal_of, warn_of_turned

HEADER = 84  # bytes before the first triangle
KEYWORDS = ("solid", "facet", "outer", "vertex", "endloop", "endfacet", "endsolid")
ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@dataclass(frozen=True, eq=False)
class Solid:
    """A solid's name as the file has it, and (n, 3, 3) corners."""

    name: str
    corners: np.ndarray


def read_stl(path: Path) -> list[Part]:
    """A part for every solid of an ASCII file; a binary file is one.

    Raises:
        SceneError: truncated or damaged.
    """
    data = path.read_bytes()
    count = int.from_bytes(data[80:HEADER], "little") if len(data) >= HEADER else -1
    size = HEADER + ROW.itemsize * count
    # many binary files begin with the word solid, too: what tells ASCII is that there is a facet, and no byte that is not text
    head = data[:4096].lower()
    text = head.lstrip().startswith(b"solid") and (b"facet" in head or b"endsolid" in head) and b"\0" not in head
    if count >= 0 and (len(data) == size or (not text and count > 0 and len(data) > size)):
        solids = [_binary(path, data, count)]
    elif text:
        solids = _ascii(path, data)
    else:
        announced = f"its header announces {count} triangles ({size} bytes), it has {len(data)} bytes"
        raise SceneError(f"{path}: {announced if count >= 0 else 'too short'}; the STL file is truncated or damaged")
    if several := repeated([solid.name for solid in solids if solid.name]):
        warn(f"{path}: solids of the same name get numbers (name#2, ...) in the order of the file: {shown(several)}")
    taken: dict[str, int] = {}
    return [
        Part(
            numbered(solid.name, taken) if solid.name else path.stem,
            solid.corners.reshape(-1, 3).astype(np.float64),
            np.arange(3 * len(solid.corners)).reshape(-1, 3),
        )
        for solid in solids
    ]


def _binary(path: Path, data: bytes, count: int) -> Solid:
    table = np.frombuffer(data, ROW, count, HEADER)
    warn_of_turned(path, table["normal"], table["corners"])
    if b"COLOR=" in data[:HEADER]:
        warn(f"{path}: the colour in the header (COLOR=) is left out")
    if left := len(data) - HEADER - table.nbytes:
        warn(f"{path}: {left} bytes after the last of {count} triangles are left out")
    if colored := int((table["attribute"] != 0).sum()):
        warn(f"{path}: attributes (colours, as some programs write them) of {colored} triangles are left out")
    return Solid("", table["corners"])


def _ascii(path: Path, data: bytes) -> list[Solid]:
    found: list[tuple[str, list[str]]] = []
    normals: list[list[float]] = []
    count = {"facet": 0, "endfacet": 0, "vertex": 0}
    text = decode(data, str(path)).text.replace("\r\n", "\n").replace("\r", "\n")
    for number, line in enumerate(text.split("\n"), 1):
        words = line.split()
        key = words[0].lower() if words else ""
        if key == "solid":
            found.append((" ".join(words[1:]), []))
        elif key in count and found:
            count[key] += 1
            if key == "facet":
                normals.append(normal_of(words))
            if key == "endfacet" and count["vertex"] != 3 * count["facet"]:
                break
            if key == "vertex":
                if len(words) != 4:
                    raise SceneError(f"{path}, line {number}: '{line.strip()[:80]}' is no vertex of three numbers; it is damaged")
                found[-1][1].extend(words[1:])
    last = text.strip().rsplit("\n", 1)[-1]
    end = last.split()[0].lower()
    if end not in KEYWORDS:
        raise SceneError(f"{path}: the file ends in '{last.strip()[:80]}', which is no line of STL; it is truncated or damaged")
    if end != "endsolid":
        warn(f"{path}: the file ends without endsolid; it may be truncated")
    if not count["facet"] == count["endfacet"] == count["vertex"] / 3:
        raise SceneError(
            f"{path}: {count['endfacet']} of {count['facet']} facets are complete, with {count['vertex']} vertices; "
            "the file is truncated or damaged"
        )
    try:
        solids = [Solid(name, np.array(words, np.float64).reshape(-1, 3, 3)) for name, words in found if words]
    except ValueError as error:
        raise SceneError(f"{path}: a vertex is no number ({error}); the file is damaged") from None
    if solids:
        warn_of_turned(path, np.array(normals), np.concatenate([solid.corners for solid in solids]))
    return solids
