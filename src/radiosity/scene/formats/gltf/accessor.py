"""glTF accessors: typed numbers out of buffer views, strided, sparse or normalised."""

import numpy as np

from ....errors import shown
from .file import GltfFile

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
MOST_UNSTORED = 2**27  # numbers in an accessor that has no bytes of its own


def accessor(file: GltfFile, index, rows: np.ndarray | None = None) -> np.ndarray:
    """Return the values, (count, width) float64, or int32 or int64 where the accessor holds integers that are not normalised.

    Args:
        rows: (n,) int, those that are wanted, all below ``count``; None: all.

    Raises:
        SceneError: the accessor does not exist, or does not fit its bytes.
    """
    info, what = file.item("accessors", index), f"accessor {index}"
    count, width = file.whole(info, "count", what), WIDTHS.get(str(info.get("type")), 0)
    dtype = _component(file, info, what)
    if not width:
        raise file.fail(f"type of {what} is {info.get('type')!r}; expected one of {shown(WIDTHS)}")
    if "bufferView" in info:
        values = _values(file, info, count, width, dtype, what)
    elif count * width > MOST_UNSTORED:
        raise file.fail(f"{what} announces {count} elements without bytes for them")
    else:
        values = np.zeros((count, width), dtype)
    if "sparse" in info:
        values = _sparse(file, file.dictionary(info["sparse"], f"sparse of {what}"), values.copy(), what)
    if rows is not None:
        values = values[rows]
    if dtype.kind == "f":
        return values.astype(np.float64)
    if info.get("normalized") is True:
        return np.maximum(values / np.iinfo(dtype).max, -1.0)
    if dtype == "<u4" and values.max(initial=0) < 2**31:
        return np.ascontiguousarray(values).view(np.int32)
    return values.astype(np.int64)


def _component(file: GltfFile, info: dict, what: str) -> np.dtype:
    code = info.get("componentType")
    if not isinstance(code, int) or code not in COMPONENTS:
        raise file.fail(f"componentType of {what} is {code!r}; expected one of {shown(COMPONENTS)}")
    return np.dtype(COMPONENTS[code])


def _values(file: GltfFile, info: dict, count: int, width: int, dtype: np.dtype, what: str) -> np.ndarray:
    data, stride = file.view(info.get("bufferView"))
    start, row = file.whole(info, "byteOffset", what, 0), width * dtype.itemsize
    stride = stride or row
    if stride < row or (count and start + (count - 1) * stride + row > len(data)):
        raise file.fail(
            f"{what} needs {count} elements of {row} bytes, {stride} apart, from byte {start}; its view has {len(data)} bytes"
        )
    return np.ndarray((count, width), dtype, data, start, (stride, dtype.itemsize)) if count else np.zeros((0, width), dtype)


def _sparse(file: GltfFile, info: dict, values: np.ndarray, what: str) -> np.ndarray:
    count = file.whole(info, "count", f"sparse of {what}")
    place, new = (file.dictionary(info.get(key), f"sparse {key} of {what}") for key in ("indices", "values"))
    at = _values(file, place, count, 1, _component(file, place, what), what)[:, 0]
    if count and (at.dtype.kind != "u" or at.max() >= len(values)):
        raise file.fail(f"sparse index {at.max()} of {what} is out of range; it has {len(values)} elements")
    values[at] = _values(file, new, count, values.shape[1], values.dtype, what)
    return values
