"""Curved shapes as flat faces whose total area is that of the shape, so that emitters keep their power.

Their corners lie a little outside of the shape.
"""

from functools import cache

import numpy as np

AROUND = 32  # faces around a disk, a cylinder or a sphere's equator
ROWS = 16  # of a sphere


@cache
def sphere() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a sphere of radius 1 about the origin, its fronts outside.

    Returns:
        (n, 3) corners; (m, 4) faces, -1 in the last column of triangles; (n, 2) angles about z and from z, as shares of a turn
        and of half a turn.
    """
    u, v = np.meshgrid(np.linspace(0, 1, AROUND + 1), np.linspace(0, 1, ROWS + 1))
    uv = np.column_stack([u.ravel(), v.ravel()])
    phi, theta = 2 * np.pi * uv[:, 0], np.pi * uv[:, 1]
    unit = np.column_stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    row, i = (index.ravel() for index in np.meshgrid(np.arange(ROWS), np.arange(AROUND), indexing="ij"))
    above, below = row * (AROUND + 1) + i, (row + 1) * (AROUND + 1) + i
    faces = np.column_stack([above, below, below + 1, above + 1])
    top, bottom = row == 0, row == ROWS - 1
    faces[top] = np.column_stack([above, below, below + 1, np.full(len(row), -1)])[top]
    faces[bottom] = np.column_stack([above, below, above + 1, np.full(len(row), -1)])[bottom]
    p = unit[np.where(faces >= 0, faces, faces[:, [0]])]
    halves = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 0])
    area = sum(np.linalg.norm(half, axis=1).sum() / 2 for half in halves)
    return np.sqrt(4 * np.pi / area) * unit, faces, uv


def frustum(start: np.ndarray, end: np.ndarray, radii: tuple[float, float], axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the side of a cone whose tip is cut off; a cylinder where both radii are equal, a ring where both ends are.

    Args:
        start, end: (3,) middle of its ends.
        radii: of its ends; one may be 0.
        axis: (3,) unit vector from ``start`` to ``end``; of a ring, that which its front looks to where the first radius is
            larger.

    Returns:
        (n, 3) corners, and (m, 4) faces, -1 in the last column of triangles. The fronts are outside.
    """
    first, second = radii
    height, across = float(np.linalg.norm(end - start)), second - first
    # the flat faces have the area pi (r + r') sqrt(h² + (r' - r)²) if radii grow by the root of k
    share, slant = (AROUND / np.pi * np.sin(np.pi / AROUND)) ** 2, np.cos(np.pi / AROUND) ** 2
    whole = (height**2 + across**2) / share
    k = 2 * whole / (height**2 + np.sqrt(height**4 + 4 * slant * across**2 * whole))
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    around = np.column_stack([np.cos(angle), np.sin(angle)]) @ perpendicular(axis) * np.sqrt(k)
    vertices = np.concatenate([start + first * around, end + second * around])
    i, none = np.arange(AROUND), np.full(AROUND, -1)
    after = (i + 1) % AROUND
    if first == 0:
        return vertices, np.column_stack([i, AROUND + after, AROUND + i, none])
    if second == 0:
        return vertices, np.column_stack([i, after, AROUND + i, none])
    return vertices, np.column_stack([i, after, AROUND + after, AROUND + i])


def perpendicular(axis: np.ndarray) -> np.ndarray:
    """Return two unit vectors that stand at right angles on an axis and on each other, counterclockwise about it, (2, 3)."""
    one = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    one /= np.linalg.norm(one)
    return np.array([one, np.cross(axis, one)])
