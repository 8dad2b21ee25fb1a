"""Checks of an NPZ file before its arrays take memory: its headers must agree with its contents."""

import math
import zipfile
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ..errors import SceneError

MOST_UNPACKED = 200  # largest ratio of unpacked to packed bytes; counters and zeros compress well
MOST_MEMBERS = 10_000


def check_sizes(opened: BinaryIO, path: Path) -> None:
    """Check the headers of all members of an open file, and go back to its beginning.

    Raises:
        SceneError: a member is no plain array, announces more numbers than it holds, or unpacks to very much more than the file.
        zipfile.BadZipFile, ValueError, EOFError, KeyError: the file is damaged.
    """
    size = opened.seek(0, 2)
    opened.seek(0)
    with zipfile.ZipFile(opened) as archive:
        members = archive.infolist()
        whole = sum(member.file_size for member in members)
        if len(members) > MOST_MEMBERS or whole > MOST_UNPACKED * size:
            raise SceneError(
                f"{path}: {len(members)} members would unpack to {whole:,} bytes from a file of {size:,}; it is no solution of "
                "this program"
            )
        for member in members:
            _check_member(archive, member, path)
    opened.seek(0)


def _check_member(archive: zipfile.ZipFile, member: zipfile.ZipInfo, path: Path) -> None:
    with archive.open(member) as file:
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = read(file)
        if dtype.hasobject:
            raise SceneError(
                f"{path}: '{member.filename[:60]}' holds Python objects, which are never read; it is no solution of this program"
            )
        announced, held = math.prod(shape) * dtype.itemsize, member.file_size - file.tell()
        if announced != held:
            raise SceneError(
                f"{path}: '{member.filename[:60]}' announces {announced:,} bytes and holds {held:,}; the file is damaged"
            )
