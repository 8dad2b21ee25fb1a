"""Colours of a PLY file's vertices and faces: which properties they are, and how they are scaled."""

from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...assemble import warn
from ..mesh_colors import FULL, are_bytes, warn_of_bytes
from ..textures import decode_srgb
from .ply_rows import Columns

# as most programs name them, as others do (Mitsuba, assimp), and as scanners do
NAMES = (("red", "green", "blue"), ("r", "g", "b"), ("diffuse_red", "diffuse_green", "diffuse_blue"))
OPACITIES = ("alpha", "a", "opacity", "diffuse_alpha")
# words in names of properties that would change the colours if they were read
TELLING = (
    "red",
    "green",
    "blue",
    "color",
    "colour",
    "gray",
    "grey",
    "intensity",
    "emission",
    "emissive",
    "radiance",
    "reflectance",
)
LARGEST = 65535


def colors_of(path: Path, columns: Columns, element: str) -> np.ndarray | None:
    """Return linear colours of an element, (n, 3), or None. Whole numbers are sRGB, floating point numbers linear.

    Raises:
        SceneError: whole numbers that are no colours.
    """
    held = {name.lower(): values for name, values in columns.numbers.items()}
    used = next((names for names in NAMES if set(names) <= set(held)), ())
    _warn_of_others(path, columns, element, held, used)
    if not used:
        return None
    found = [held[name] for name in used]
    color = np.column_stack(found)
    if color.dtype.kind == "f":
        color = color.astype(np.float64)
        if not are_bytes(color):
            return color
        warn_of_bytes(path, [element])
        return decode_srgb(color / FULL)
    largest = max(np.iinfo(column.dtype).max for column in found)
    if largest > LARGEST:
        largest = FULL
    if color.min(initial=0) < 0 or color.max(initial=0) > largest:
        raise SceneError(f"{path}: colours reach from {color.min()} to {color.max()}; expected 0 to {largest}")
    if largest > FULL and 0 < color.max(initial=0) <= FULL:
        text = f"have {largest.bit_length()} bits and none is above {color.max()}; they are taken as 0 to {FULL}"
        warn(f"{path}: colours of the element '{element}' {text}")
        largest = FULL
    return decode_srgb(color / largest)


def _warn_of_others(path: Path, columns: Columns, element: str, held: dict[str, np.ndarray], used: tuple[str, ...]) -> None:
    """Tell of properties that are not read and would change the colours: opacity, and other properties of light and colour."""
    for name in (name for name in OPACITIES if name in held and (name != "a" or "r" in used)):
        full = 1.0 if held[name].dtype.kind == "f" and held[name].max(initial=0) <= 1 else FULL
        if (held[name] < full).any():
            warn(f"{path}: transparency ({name} of the element '{element}') is left out, taken as opaque")
    rest = [name for name in (*columns.numbers, *columns.lists) if name.lower() not in used]
    if others := [name for name in rest if any(word in name.lower() for word in TELLING)]:
        warn(f"{path}: properties of the element '{element}' that are not read: {shown(others)}")
