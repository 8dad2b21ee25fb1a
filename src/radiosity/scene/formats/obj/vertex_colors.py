"""Colours behind the coordinates of OBJ vertices: ``v x y z r g b``."""

from pathlib import Path

import numpy as np

from ...assemble import warn
from ..mesh_colors import FULL, are_bytes, warn_of_bytes

COLORED = 6  # numbers of a vertex that has a colour


def colors_of(path: Path, rows: list[list[float]]) -> np.ndarray:
    """Return sRGB colours from 0 to 1, (n, 3); NaN where a vertex has none. Warn of other numbers after the coordinates."""
    longer = sum(len(row) > COLORED for row in rows)
    if longer:
        warn(f"{path}: vertices of more than {COLORED} numbers ({longer}): the fourth to sixth are taken as red, green and blue")
    weighted = sum(3 < len(row) < COLORED and row[3] != 1 for row in rows)
    if weighted:
        warn(f"{path}: weights of vertices other than 1 (their fourth number) are left out: {weighted} vertices")
    colors = np.array([row[3:COLORED] if len(row) >= COLORED else [np.nan] * 3 for row in rows]).reshape(-1, 3)
    if not are_bytes(colors):
        return colors
    warn_of_bytes(path, ["v"])
    return colors / FULL
