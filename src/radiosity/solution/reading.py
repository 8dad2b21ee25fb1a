"""Reading of NPZ files of this program: a damaged or foreign file of any kind becomes one clear error."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..errors import SceneError
from .archive import check_sizes
from .npz import EXCHANGE, FACTORS, LINES, READERS, SOLUTION

LAST_CHARACTER = 0x10FFFF
AGAIN = {SOLUTION: "solve the scene again", LINES: "trace the lines again", EXCHANGE: "make it again"}
FIRST = {
    SOLUTION: "solve a scene with -o {name} first",
    LINES: "trace the lines of a scene with -o {name} first",
    EXCHANGE: "radiosity exchange SCENE -o {name} writes one",
}

T = TypeVar("T")


def read(path: Path, kind: str, formats: tuple[int, ...], restore: Callable[[dict[str, Any], dict[str, Any]], T]) -> T:
    """Return what a function makes of a file's arrays and facts.

    Args:
        kind: "solution", "line set" or "radiative exchange".
        formats: the formats that can be read.
        restore: takes arrays by key, and facts; any error of it means that the file is damaged.

    Raises:
        SceneError: the file is missing, damaged, or of another kind or format.
    """
    try:
        with path.open("rb") as opened:
            check_sizes(opened, path)
            with np.load(opened, allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files}
        meta = json.loads(_text(arrays["meta"]))
        found = meta.get("kind", SOLUTION)
        if found != kind and found in READERS:
            raise SceneError(f"{path}: {holds(found)}, not a {kind}; {READERS[found]} reads it")
        if meta["format"] not in formats:
            raise SceneError(f"{path}: written in format {meta['format']}; this version reads {', '.join(map(str, formats))}")
        return restore(arrays, meta)
    except FileNotFoundError:
        name = path.with_suffix(".npz").name if path.name else "NAME.npz"
        raise SceneError(f"{path}: no such file; {FIRST[kind].format(name=name)}") from None
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from None
    except MemoryError:
        raise SceneError(f"{path}: too large for the memory of this machine") from None
    except Exception as error:  # a damaged file of any kind must become a SceneError
        if isinstance(error, SceneError):
            raise
        text = " ".join(str(error).split())[:200]
        raise SceneError(f"{path}: is no {kind} of this program, or damaged ({text}); {AGAIN[kind]}") from None


def holds(kind: str) -> str:
    """Return what a file of a kind holds, in words."""
    return f"holds {kind}" if kind == FACTORS else f"holds a {kind}"


def _text(value: np.ndarray) -> str:
    """Return the text of an array that holds one.

    Numpy takes any four bytes for a character. Bytes that are no character for Python would fail much later.
    """
    native = value.astype(value.dtype.newbyteorder("="))
    if value.dtype.kind != "U" or value.ndim or (np.frombuffer(native.tobytes(), np.uint32) > LAST_CHARACTER).any():
        raise ValueError("meta is no text")
    return str(native)
