"""PLY files as tables of numbers: ASCII or binary, lists of any length.

Read here and not through trimesh, which refuses binary files that mix triangles and quadrilaterals.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...assemble import warn
from ..encoding import decode
from ..names import repeated
from ..room import refuse
from .ply_rows import Columns, Property, read_ascii, read_binary

TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "int64": "i8",
    "uint64": "u8",
    "float32": "f4",
    "float64": "f8",
}
WITH_FACES = ("vertex", "face", "tristrips")
FACE, WORD = 100, 40  # bytes of memory beside the file: for a face of a binary one; for a number of an ASCII one
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True, eq=False)
class Ply:
    """Columns by element, and the header's comments."""

    columns: dict[str, Columns]
    comments: list[str]


def read_ply(path: Path) -> Ply:
    """Read all elements up to the last of those that make faces; others are told of and left out.

    Raises:
        SceneError: not a PLY file, or fewer bytes or numbers than the header announces.
    """
    data = path.read_bytes()
    if not data.startswith(b"ply"):
        raise SceneError(f"{path}: does not begin with 'ply'; it is damaged or of another format")
    lines, body = _parted(path, data)
    order, elements, comments = _header(path, lines)
    if several := repeated([name for name, _, _ in elements]):
        raise SceneError(f"{path}: the header has elements of the same name: {shown(several)}; the file is damaged")
    wanted = {name for name, _, _ in elements if name in WITH_FACES}
    if others := [f"{name} ({count})" for name, count, _ in elements if name not in WITH_FACES and count]:
        warn(f"{path}: elements that are left out: {shown(others)}")
    _check_memory(path, len(data), bool(order), elements)
    columns = {}
    words = np.array([]) if order else _numbers(path, body)
    at = 0
    for name, count, properties in elements:
        kind = f"{count} rows of element '{name}'"
        least = sum((p.count or p.dtype).itemsize for p in properties) if order else len(properties)
        have = len(body) - at if order else len(words) - at
        if count * least > have:
            raise SceneError(
                f"{path}: the header announces {kind}, at least {count * least} {'bytes' if order else 'numbers'}; "
                f"{have} are left: the file is truncated or damaged"
            )
        try:
            if order:
                columns[name], at = read_binary(body, at, count, properties)
            else:
                columns[name], at = read_ascii(words, at, count, properties)
        except (ValueError, IndexError, OverflowError):
            raise SceneError(f"{path}: the file ends within the {kind}; it is truncated or damaged") from None
        if wanted <= columns.keys():
            break
    if len(columns) == len(elements):  # of others that follow, the end is not known
        _tell_of_rest(path, body[at:] if order else words[at:])
    return Ply(columns, comments)


def _check_memory(path: Path, size: int, binary: bool, elements: list[tuple[str, int, list[Property]]]) -> None:
    """Refuse a file whose faces, or numbers of text, do not fit in memory; a header that announces too many is damage."""
    faces = min(size // 4, sum(count for name, count, _ in elements if name == "face"))
    words = min(size // 2, sum(count * (len(rows) + 3 * (name == "face")) for name, count, rows in elements))
    refuse(path, size + (FACE * faces if binary else WORD * words), f"reading its {faces:,} faces takes")


def _tell_of_rest(path: Path, rest: memoryview | np.ndarray) -> None:
    """Warn of data after the last element: the header may announce too few."""
    many, what = len(rest), "numbers" if isinstance(rest, np.ndarray) else "bytes"
    if many and (what == "numbers" or bytes(rest).strip(b"\0 \t\r\n")):
        warn(f"{path}: {many} {what} after the last row that the header announces are left out; its counts may be too low")


def _parted(path: Path, data: bytes) -> tuple[list[str], memoryview]:
    """Lines of the header, and the bytes after it. Lines end as the first one does, so that data may begin with any byte."""
    ends = re.match(rb"ply[ \t]*(\r\n|\n|\r)", data)
    usual = re.escape(ends[1]) if ends else b"\n"
    end = re.search(rb"(?<=[\r\n])[ \t]*end_header[ \t]*(?:" + usual + rb"|\r\n|\n|\r|\Z)", data)
    if ends is None or end is None:
        raise SceneError(f"{path}: the header has no end (a line end_header); the file is truncated")
    text = decode(data[: end.start()], str(path)).text
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), memoryview(data)[end.end() :]


def _header(path: Path, lines: list[str]):
    elements, comments = [], []
    kinds = [line.split()[1] for line in lines if line.startswith("format ") and len(line.split()) > 1]
    if not kinds or kinds[0] not in ORDERS:
        raise SceneError(
            f"{path}: the header's format is {kinds[0] if kinds else 'missing'}; expected one of {', '.join(ORDERS)}"
        )
    order = ORDERS[kinds[0]]
    for line in lines[1:]:
        words = line.split()
        try:
            match words:
                case [] | ["format", *_]:
                    pass
                case ["comment" | "obj_info", *_]:
                    comments.append(line.split(None, 1)[1] if len(words) > 1 else "")
                case ["element", name, count] if int(count) >= 0:
                    elements.append((name, int(count), []))
                case ["property", "list", count, kind, name] if TYPES[count][0] != "f":
                    elements[-1][2].append(Property(name, np.dtype(order + TYPES[kind]), np.dtype(order + TYPES[count])))
                case ["property", kind, name]:
                    elements[-1][2].append(Property(name, np.dtype(order + TYPES[kind])))
                case _:
                    raise ValueError
        except (ValueError, KeyError, IndexError, TypeError):
            raise SceneError(f"{path}: header line '{line.strip()[:80]}' is not understood; the file is damaged") from None
    return order, elements, comments


def _numbers(path: Path, body: memoryview) -> np.ndarray:
    words = bytes(body).split()
    try:
        return np.array(words, dtype=np.float64)
    except ValueError as error:
        raise SceneError(f"{path}: the data are no plain numbers ({error})") from None
