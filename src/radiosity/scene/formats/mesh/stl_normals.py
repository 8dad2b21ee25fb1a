"""Normals that an STL file gives its triangles, beside those that the order of the corners makes."""

from pathlib import Path

import numpy as np

from ...assemble import warn

OPPOSITE = -0.5  # cosine between both normals below which one is the other turned round


def normal_of(words: list[str]) -> list[float]:
    """The numbers of a line ``facet normal x y z``; zeros where there are none."""
    try:
        x, y, z = (float(word) for word in words[2:])
    except ValueError:
        return [0.0, 0.0, 0.0]
    return [x, y, z]


def warn_of_turned(path: Path, normals: np.ndarray, corners: np.ndarray) -> None:
    """Tell of normals (n, 3) that point to the backs of triangles (n, 3, 3): corners hold."""
    given = np.nan_to_num(np.asarray(normals, np.float64), posinf=0, neginf=0)
    one, two, three = np.moveaxis(np.nan_to_num(np.asarray(corners, np.float64), posinf=0, neginf=0), 1, 0)
    made = np.cross(two - one, three - one)
    lengths = np.linalg.norm(given, axis=1) * np.linalg.norm(made, axis=1)
    turned = int(((given * made).sum(axis=1) < OPPOSITE * lengths).sum())
    if turned:
        text = f"normals of {turned} of {len(given)} triangles point to the back"
        warn(f"{path}: {text}; the order of the corners says which side is the front (flip = true in a .toml turns a surface)")
