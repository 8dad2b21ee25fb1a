"""PLY files as tables of numbers: ASCII or binary, lists of any length.

Read here and not through trimesh, which refuses binary files that mix triangles and quadrilaterals.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import SceneError

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8",
    "float32": "f4", "float64": "f8",
}  # fmt: skip
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True)
class Property:
    """``dtype`` of the values; ``count`` of their number where they are a list, else None."""

    name: str
    dtype: np.dtype
    count: np.dtype | None = None


@dataclass(frozen=True, eq=False)
class Lists:
    """Rows of different length: ``values`` of all rows, one after another, and each row's ``sizes``."""

    values: np.ndarray
    sizes: np.ndarray


@dataclass(frozen=True, eq=False)
class Ply:
    """Columns by element and property, (n,) arrays or `Lists`, and the header's comments."""

    columns: dict[str, dict[str, np.ndarray | Lists]]
    comments: list[str]


def read_ply(path: Path) -> Ply:
    """Read all elements up to ``face``; what follows is not needed.

    Raises:
        SceneError: not a PLY file, or fewer bytes or numbers than the header announces.
    """
    data = path.read_bytes()
    if not data.startswith(b"ply"):
        raise SceneError(f"{path}: does not begin with 'ply'; it is damaged or of another format")
    end = data.find(b"end_header")
    line_end = data.find(b"\n", end)
    if end < 0:
        raise SceneError(f"{path}: the header has no end; the file is truncated")
    body = data[line_end + 1 :] if line_end >= 0 else b""
    order, elements, comments = _header(path, data[:end].decode("latin-1"))
    columns = {}
    words = np.array([]) if order else _numbers(path, body)
    at = 0
    for name, count, properties in elements:
        kind = f"{count} rows of element '{name}'"
        least = sum((p.count or p.dtype).itemsize for p in properties) if order else len(properties)
        have = len(body) - at if order else len(words) - at
        if count * least > have:
            raise SceneError(f"{path}: the header announces {kind}, at least {count * least} {'bytes' if order else 'numbers'}; "
                             f"{have} are left: the file is truncated or damaged")  # fmt: skip
        read = _binary if order else _ascii
        try:
            columns[name], at = read(body if order else words, at, count, properties)
        except (ValueError, IndexError, OverflowError):
            raise SceneError(f"{path}: the file ends within the {kind}; it is truncated or damaged") from None
        if name == "face":
            break
    return Ply(columns, comments)


def _header(path: Path, text: str):
    elements, comments = [], []
    kinds = [line.split()[1] for line in text.splitlines() if line.startswith("format ") and len(line.split()) > 1]
    if not kinds or kinds[0] not in ORDERS:
        raise SceneError(
            f"{path}: the header's format is {kinds[0] if kinds else 'missing'}; expected one of {', '.join(ORDERS)}"
        )
    order = ORDERS[kinds[0]]
    for line in text.splitlines()[1:]:
        words = line.split()
        try:
            match words:
                case [] | ["obj_info" | "format", *_]:
                    pass
                case ["comment", *_]:
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


def _numbers(path: Path, body: bytes) -> np.ndarray:
    words = body.split()
    try:
        return np.array(words, dtype=np.float64)
    except ValueError as error:
        raise SceneError(f"{path}: the data are no plain numbers ({error})") from None


def _ascii(words: np.ndarray, at: int, count: int, properties):
    if all(p.count is None for p in properties):
        table = words[at : at + count * len(properties)].reshape(count, len(properties))
        return {p.name: table[:, i].astype(p.dtype) for i, p in enumerate(properties)}, at + table.size
    found = [([], []) for _ in properties]
    for _ in range(count):
        for p, (values, sizes) in zip(properties, found, strict=True):
            size = 1 if p.count is None else _size(words[at])
            at += p.count is not None
            if at + size > len(words):
                raise IndexError
            values.append(words[at : at + size])
            sizes.append(size)
            at += size
    return _columns(properties, found), at


def _size(value) -> int:
    if not 0 <= value < 2**31 or value != int(value):
        raise ValueError
    return int(value)


def _binary(body: bytes, at: int, count: int, properties):
    sizes = _first_sizes(body, at, properties) if count else [1] * len(properties)
    row = np.dtype([(f"{kind}{i}", t, n) for i, (p, size) in enumerate(zip(properties, sizes, strict=True))
                    for kind, t, n in ([("n", p.count, ())] if p.count else []) + [("v", p.dtype, (size,))]])  # fmt: skip
    if at + count * row.itemsize <= len(body):
        table = np.frombuffer(body, row, count, at)
        if all((table[f"n{i}"] == size).all() for i, (p, size) in enumerate(zip(properties, sizes, strict=True)) if p.count):
            found = [([table[f"v{i}"].ravel()], np.full(count, size)) for i, size in enumerate(sizes)]
            return _columns(properties, found), at + count * row.itemsize
    found = [([], []) for _ in properties]
    for _ in range(count):
        for p, (values, sizes) in zip(properties, found, strict=True):
            size = 1
            if p.count is not None:
                size = int(np.frombuffer(body, p.count, 1, at)[0])
                at += p.count.itemsize
            values.append(np.frombuffer(body, p.dtype, size, at) if size else np.zeros(0, p.dtype))
            sizes.append(size)
            at += size * p.dtype.itemsize
    return _columns(properties, found), at


def _first_sizes(body: bytes, at: int, properties) -> list[int]:
    sizes = []
    for p in properties:
        size = 1
        if p.count is not None:
            size = int(np.frombuffer(body, p.count, 1, at)[0])
            at += p.count.itemsize
            if size < 0 or size * p.dtype.itemsize > len(body) - at:
                raise IndexError
        sizes.append(size)
        at += size * p.dtype.itemsize
    return sizes


def _columns(properties, found) -> dict[str, np.ndarray | Lists]:
    result = {}
    for p, (values, sizes) in zip(properties, found, strict=True):
        flat = (np.concatenate(values) if len(values) else np.zeros(0)).astype(p.dtype.newbyteorder("="))
        result[p.name] = flat if p.count is None else Lists(flat, np.asarray(sizes, np.int64))
    return result
