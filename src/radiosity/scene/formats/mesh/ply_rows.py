"""Rows of a PLY element as columns; lists may differ in length from row to row."""

from dataclasses import dataclass
from struct import Struct
from typing import Any

import numpy as np

from ....pieces import pieces

CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "i8": "q", "u8": "Q"}  # of `struct`


@dataclass(frozen=True)
class Property:
    """A property: ``dtype`` of its values, and ``count`` of their number where they are a list, else None."""

    name: str
    dtype: np.dtype
    count: np.dtype | None = None


@dataclass(frozen=True, eq=False)
class Lists:
    """Rows of different length: ``values`` of all rows, one after another, and each row's ``sizes``."""

    values: np.ndarray
    sizes: np.ndarray


@dataclass(frozen=True, eq=False)
class Columns:
    """The properties of an element by name: one number a row, or lists."""

    numbers: dict[str, np.ndarray]
    lists: dict[str, Lists]


def read_ascii(words: np.ndarray, at: int, count: int, properties: list[Property]) -> tuple[Columns, int]:
    """Columns of ``count`` rows from a file's numbers, and where they end. ValueError or IndexError: they do not fit."""
    if all(p.count is None for p in properties):
        table = words[at : at + count * len(properties)].reshape(count, len(properties))
        return Columns({p.name: table[:, i].astype(p.dtype) for i, p in enumerate(properties)}, {}), at + table.size
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


def read_binary(body: memoryview, at: int, count: int, properties: list[Property]) -> tuple[Columns, int]:
    """Columns of ``count`` rows from bytes, and where they end. ValueError or IndexError: they do not fit."""
    sizes = _first_sizes(body, at, properties) if count else [1] * len(properties)
    row = np.dtype(
        [
            (f"{kind}{i}", t, n)
            for i, (p, size) in enumerate(zip(properties, sizes, strict=True))
            for kind, t, n in ([("n", p.count, ())] if p.count else []) + [("v", p.dtype, (size,))]
        ]
    )
    if at + count * row.itemsize <= len(body):
        table = np.frombuffer(body, row, count, at)
        if all((table[f"n{i}"] == size).all() for i, (p, size) in enumerate(zip(properties, sizes, strict=True)) if p.count):
            found = [([_packed(table, f"v{i}")], np.broadcast_to(np.int64(size), count)) for i, size in enumerate(sizes)]
            return _columns(properties, found), at + count * row.itemsize
    places, end = _places(body, at, count, properties)
    data = np.frombuffer(body, np.uint8)
    found = [([_gathered(data, *place, p.dtype)], place[1]) for p, place in zip(properties, places, strict=True)]
    return _columns(properties, found), end


def _places(body: memoryview, at: int, count: int, properties: list[Property]) -> tuple[list[tuple[np.ndarray, np.ndarray]], int]:
    """Return where the values of each property begin in each row, and how many there are, (count,) int64; and where rows end."""
    reads = [p.count and Struct(p.count.str[0].replace("|", "<") + CODES[p.count.str[1:]]) for p in properties]
    plain = [(read, read.size if read else 0, p.dtype.itemsize) for read, p in zip(reads, properties, strict=True)]
    begins, sizes = [[] for _ in properties], [[] for _ in properties]
    takes, end = [(one.append, other.append) for one, other in zip(begins, sizes, strict=True)], len(body)
    for _ in range(count):
        for (read, before, width), (begin, many) in zip(plain, takes, strict=True):
            size = 1
            if read is not None:
                if at + before > end:
                    raise IndexError
                size = read.unpack_from(body, at)[0]
                at += before
            if size < 0 or size * width > end - at:
                raise IndexError
            begin(at)
            many(size)
            at += size * width
    return [(np.asarray(one, np.int64), np.asarray(other, np.int64)) for one, other in zip(begins, sizes, strict=True)], at


def _gathered(data: np.ndarray, begins: np.ndarray, sizes: np.ndarray, dtype: np.dtype) -> np.ndarray:
    """Return runs of values one after another, that begin at some bytes."""
    ends = np.cumsum(sizes)
    result = np.empty((int(ends[-1]) if len(ends) else 0, dtype.itemsize), np.uint8)
    within = np.arange(dtype.itemsize)
    for part in pieces(len(sizes)):
        size, first = sizes[part], int(ends[part.start] - sizes[part.start])
        number = np.arange(first, int(ends[part.stop - 1]))
        byte = np.repeat(begins[part] - dtype.itemsize * (ends[part] - size), size) + dtype.itemsize * number
        result[first : first + len(number)] = data[byte[:, None] + within]
    return result.view(dtype).ravel()


def _packed(table: np.ndarray, name: Any) -> np.ndarray:
    """Return the values of a field of several numbers, one after another; rows are moved as bytes, which NumPy does fastest."""
    assert table.dtype.fields is not None
    kind, offset = table.dtype.fields[name][:2]
    if not table.size or not kind.itemsize:
        return table[name].ravel()
    rows: Any = {"names": [name], "formats": [f"V{kind.itemsize}"], "offsets": [offset], "itemsize": table.dtype.itemsize}
    return np.ascontiguousarray(table.view(np.dtype(rows))[name]).view(kind.base)


def _first_sizes(body: memoryview, at: int, properties) -> list[int]:
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


def _columns(properties, found) -> Columns:
    result = Columns({}, {})
    for p, (values, sizes) in zip(properties, found, strict=True):
        flat = values[0] if len(values) == 1 else np.concatenate(values) if len(values) else np.zeros(0)
        flat = flat.astype(p.dtype.newbyteorder("="), copy=False)
        if p.count is None:
            result.numbers[p.name] = flat
        else:
            result.lists[p.name] = Lists(flat, np.asarray(sizes, np.int64))
    return result
