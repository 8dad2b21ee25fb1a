"""Boxes and parallelograms for the built-in scenes."""

import numpy as np

from .model import Scene


def quad(origin, first, second) -> np.ndarray:
    """Return the corners of a parallelogram, (4, 3); the front is on the side of first x second."""
    o, a, b = (np.asarray(x, np.float64) for x in (origin, first, second))
    return np.array([o, o + a, o + a + b, o + b])


def box(low, high, *, inward: bool = False, turn: float = 0.0) -> list[np.ndarray]:
    """The faces of a box (y low, y high, x low, x high, z low, z high), turned by degrees about its vertical axis."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    dx, dy, dz = x1 - x0, y1 - y0, z1 - z0
    faces = [
        quad((x0, y0, z0), (dx, 0, 0), (0, 0, dz)),
        quad((x0, y1, z0), (0, 0, dz), (dx, 0, 0)),
        quad((x0, y0, z0), (0, 0, dz), (0, dy, 0)),
        quad((x1, y0, z0), (0, dy, 0), (0, 0, dz)),
        quad((x0, y0, z0), (0, dy, 0), (dx, 0, 0)),
        quad((x0, y0, z1), (dx, 0, 0), (0, dy, 0)),
    ]
    if inward:
        faces = [face[[0, 3, 2, 1]] for face in faces]
    if turn:
        angle = np.deg2rad(turn)
        rotation = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        centre = np.array([(x0 + x1) / 2, (y0 + y1) / 2, 0])
        faces = [(face - centre) @ rotation.T + centre for face in faces]
    return faces


def join(parts, *, source: str, cameras=(), backs: dict[str, float] | None = None) -> Scene:
    """A grey scene from (name, reflectance, emission, [corners, ...]); backs of named surfaces reflect but do not emit."""
    backs = backs or {}
    rows = [(i, reflectance, emission, corners) for i, (_, reflectance, emission, quads) in enumerate(parts) for corners in quads]
    return Scene.from_arrays(
        np.concatenate([corners for *_, corners in rows]),
        np.arange(4 * len(rows)).reshape(-1, 4),
        np.array([r for _, r, _, _ in rows], np.float64),
        np.array([e for _, _, e, _ in rows], np.float64),
        surface=[i for i, *_ in rows],
        two_sided=np.array([parts[i][0] in backs for i, *_ in rows]),
        back_reflectance=np.array([backs.get(parts[i][0], 0.0) for i, *_ in rows]),
        back_emission=np.zeros(len(rows)),
        names=[name for name, *_ in parts],
        source=source,
        cameras=cameras,
    )
