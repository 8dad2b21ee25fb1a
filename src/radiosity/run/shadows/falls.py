"""How far light falls across borders of shadows, within about a patch."""

import numpy as np

from ...scene.model import Scene
from .borders import Borders
from .lights import Light
from .receivers import Receivers
from .sight import Sight

PLACES = 16  # along a line, at most
BESIDE = 0.375  # of a patch's size: so far from a line light is compared


def falls(
    scene: Scene, sight: Sight, receivers: Receivers, lights: list[Light], found: Borders, uv: np.ndarray, size: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return how much light differs across lines from half a patch to half a patch, and what would arrive without shadows, (m,)
    root mean squares along the lines.

    Args:
        uv: (m, 2, 2) ends in face coordinates.
    """
    face, normals = receivers.face[found.side], receivers.normals(scene)[found.side]
    origin, first, second = (part[face] for part in scene.frames)
    start, end = (origin + uv[:, k, :1] * first + uv[:, k, 1:] * second for k in (0, 1))
    step = end - start
    length = np.linalg.norm(step, axis=1)
    across = np.cross(normals, step / length[:, None]) * (BESIDE * size)
    to_face = np.stack([np.linalg.pinv(np.stack(pair, axis=1)) for pair in zip(first, second, strict=True)])
    squares = np.zeros((2, len(face)))
    for number, light in enumerate(lights):
        rows = np.flatnonzero(found.light == number)
        count = np.clip(np.ceil(2 * length[rows] / size), 2, PLACES).astype(np.int64)
        row = np.repeat(rows, count)
        at = (np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / np.repeat(count, count)
        middle = start[row] + at[:, None] * step[row]
        both, inside = [], np.ones(len(row), bool)
        for points in (middle - across[row], middle + across[row]):
            u, v = np.einsum("mji,mi->jm", to_face[row], points - origin[row])
            inside &= (np.minimum(u, v) >= 0) & np.where(scene.is_quad[face[row]], np.maximum(u, v) <= 1, u + v <= 1)
            both.append(_light(sight, light, points, normals[row], face[row]))
        whole = light.irradiance(middle, normals[row], light.middle)
        for total, value in zip(squares, (inside * (both[1] - both[0]), whole), strict=True):
            total += np.bincount(row, value**2 / np.repeat(count, count), len(face))
    return np.sqrt(squares[0]), np.sqrt(squares[1])


def _light(sight: Sight, light: Light, points: np.ndarray, normals: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Return the light of a lamp that arrives at points, (m,)."""
    total = np.zeros(len(points))
    for place in light.points:
        seen = sight.met(points, normals, face, np.broadcast_to(place, (len(points), 4))) < 0
        total += light.irradiance(points, normals, place) * seen
    return total / len(light.points)
