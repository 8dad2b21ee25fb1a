"""NPZ files of anyone: nothing is unpickled, and sizes are held against the file's length before memory is taken."""

import math
import os
import zipfile
from typing import BinaryIO

import numpy as np
from numpy.lib import format as npy

MOST_RATIO = 100  # bytes unpacked for one of the file; ours are not compressed
MOST_MEMBERS = 10_000
HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_arrays(file: BinaryIO) -> dict[str, np.ndarray]:
    """All arrays of an NPZ file by name.

    Raises:
        ValueError: an array of objects, sizes that do not fit the file, or very many members.
        zipfile.BadZipFile: damaged.
    """
    length = os.fstat(file.fileno()).st_size
    with zipfile.ZipFile(file) as archive:
        members = archive.infolist()
        if len(members) > MOST_MEMBERS:
            raise ValueError(f"{len(members)} members")
        if sum(member.file_size for member in members) > MOST_RATIO * length:
            raise ValueError(f"unpacks to more than {MOST_RATIO} times its length")
        return {member.filename.removesuffix(".npy"): _array(archive, member, length) for member in members}


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo, length: int) -> np.ndarray:
    if member.compress_type == zipfile.ZIP_STORED and member.file_size > length:
        raise ValueError(f"{member.filename} announces more bytes than the file has")
    with archive.open(member) as opened:
        shape, _, dtype = HEADERS[npy.read_magic(opened)](opened)
    if dtype.hasobject:
        raise ValueError(f"{member.filename} holds objects")
    if min(shape, default=1) < 0 or math.prod(shape) * dtype.itemsize > member.file_size:
        raise ValueError(f"{member.filename} announces {shape} of {dtype}; it has {member.file_size} bytes")
    with archive.open(member) as opened:
        return npy.read_array(opened, allow_pickle=False)
