"""The surfaces of Radiance as faces. Fronts are outside; those of bubbles, cups and tubes are inside."""

import numpy as np

from ..curved import frustum, sphere
from ..faces import turned
from .primitives import Primitive

NUMBERS = {"sphere": 4, "bubble": 4, "cone": 8, "cup": 8, "cylinder": 7, "tube": 7, "ring": 8}
INSIDE = ("bubble", "cup", "tube")
SHAPES = ("polygon", *NUMBERS)


def corners_of(primitive: Primitive) -> np.ndarray:
    """The corners of a polygon, (n, 3).

    Raises:
        ValueError: there are no whole corners, or fewer than three.
    """
    count = len(primitive.numbers)
    if count % 3 or count < 9:
        raise ValueError(f"a polygon has three numbers for each of at least three corners, and not {count}")
    return np.array(primitive.numbers).reshape(-1, 3)


def curved(primitive: Primitive) -> tuple[np.ndarray, np.ndarray]:
    """The corners, (n, 3), and faces, (m, 4), of any other surface.

    Raises:
        ValueError: its numbers make no such surface.
    """
    kind, numbers = primitive.kind, np.array(primitive.numbers)
    if len(numbers) != NUMBERS[kind]:
        raise ValueError(f"a {kind} has {NUMBERS[kind]} numbers, and not {len(numbers)}")
    inside = kind in INSIDE
    if kind in ("sphere", "bubble"):
        radius = numbers[3]
        if radius == 0:
            raise ValueError(f"the radius of a {kind} is 0")
        inside ^= bool(radius < 0)  # as Radiance takes it
        unit, faces, _ = sphere()
        vertices = numbers[:3] + abs(radius) * unit
    elif kind == "ring":
        direction, radii = numbers[3:6], sorted(numbers[6:])
        length = np.linalg.norm(direction)
        if not (length > 0 and 0 <= radii[0] < radii[1]):
            raise ValueError("a ring needs a direction, and two radii that differ and are not negative")
        vertices, faces = frustum(numbers[:3], numbers[:3], (radii[1], radii[0]), direction / length)
    else:
        start, end, radii = numbers[:3], numbers[3:6], np.resize(numbers[6:], 2)
        length = np.linalg.norm(end - start)
        if not length > 0 or (radii < 0).any() != (radii < 0).all() or not radii.any():
            raise ValueError(f"a {kind} needs two ends that differ, and radii of one sign that are not both 0")
        inside ^= bool((radii < 0).all())
        one, other = np.abs(radii)
        vertices, faces = frustum(start, end, (one, other), (end - start) / length)
    return vertices, turned(faces) if inside else faces


def joined(pieces: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of several pieces together."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in pieces])
    faces = [np.where(faces >= 0, faces + start, -1) for (_, faces), start in zip(pieces, starts, strict=False)]
    return np.concatenate([vertices for vertices, _ in pieces]), np.concatenate(faces)
