"""Mitsuba's analytic shapes as faces.

Rectangle and cube are exact. Round shapes become flat faces whose total area is that of the shape, so that emitters keep
their power; their corners lie a little outside the surface.
"""

from dataclasses import dataclass, field

import numpy as np

from ..curved import AROUND
from ..curved import sphere as unit_sphere
from .node import Node


@dataclass(frozen=True, eq=False)
class Geometry:
    """Faces in their own coordinates.

    Attributes:
        vertices: (n, 3).
        faces: (m, 3) or (m, 4), -1 in the last column of a triangle; counterclockwise seen from the front.
        uv: (n, 2) Mitsuba's texture coordinates, or None.
        attributes: colours and numbers by name: (n, 1 or 3) where it begins with vertex_, (m, 1 or 3) with face_.
        own_normals: a mirror leaves the front where it is, as where normals are given; else it turns with the corners.
    """

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray | None = None
    attributes: dict[str, np.ndarray] = field(default_factory=dict)
    own_normals: bool = True


def rectangle(node: Node) -> Geometry:
    uv = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    return Geometry(np.column_stack([2 * uv - 1, np.zeros(4)]), np.array([[0, 1, 2, 3]]), uv)


def cube(node: Node) -> Geometry:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    order = [4, 5, 1, 0, 6, 2, 3, 7, 4, 6, 7, 5, 5, 7, 3, 1, 1, 3, 2, 0, 6, 4, 0, 2]  # Mitsuba's, for the texture
    uv = np.array([(0, 1), (1, 1), (1, 0), (0, 0)] * 6, float)
    return Geometry(corners[order], np.arange(24).reshape(6, 4), uv)


def disk(node: Node) -> Geometry:
    angle = np.linspace(0, 2 * np.pi, AROUND + 1)
    radius = np.sqrt(2 * np.pi / AROUND / np.sin(2 * np.pi / AROUND))
    rim = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(AROUND + 1)])
    uv = np.column_stack([np.ones(AROUND + 1), angle / (2 * np.pi)])
    # each triangle has a centre of its own, whose angle is the triangle's
    centres = np.column_stack([np.zeros(AROUND), (np.arange(AROUND) + 0.5) / AROUND])
    i = np.arange(AROUND)
    vertices = np.concatenate([rim, np.zeros((AROUND, 3))])
    return Geometry(vertices, np.column_stack([AROUND + 1 + i, i, i + 1]), np.concatenate([uv, centres]))


def cylinder_axes(node: Node) -> tuple[float, np.ndarray]:
    """The length of a cylinder, and (3, 3) unit vectors: two across and the axis."""
    first = node.vector("p0", (0, 0, 0))
    axis = node.vector("p1", (0, 0, 1)) - first
    length = np.linalg.norm(axis)
    axis = axis / length if length > 0 else np.array([0.0, 0.0, 1.0])
    # the axes of Duff and others, "Building an orthonormal basis, revisited" (2017), as Mitsuba has them
    sign = np.copysign(1.0, axis[2])
    a = -1 / (sign + axis[2])
    b = axis[0] * axis[1] * a
    across = (1 + sign * axis[0] ** 2 * a, sign * b, -sign * axis[0]), (b, sign + axis[1] ** 2 * a, -axis[1])
    return float(length), np.array([*across, axis])


def cylinder(node: Node) -> Geometry:
    first, (length, axes) = node.vector("p0", (0, 0, 0)), cylinder_axes(node)
    across, axis = axes[:2], axes[2]
    angle = np.linspace(0, 2 * np.pi, AROUND + 1)
    radius = node.number("radius", 1.0) * (np.pi / AROUND) / np.sin(np.pi / AROUND)
    rim = first + radius * np.column_stack([np.cos(angle), np.sin(angle)]) @ across
    vertices = np.concatenate([rim, rim + length * axis])
    uv = np.concatenate([np.column_stack([angle / (2 * np.pi), np.full(AROUND + 1, v)]) for v in (0.0, 1.0)])
    i, up = np.arange(AROUND), AROUND + 1
    return Geometry(vertices, np.column_stack([i, i + 1, i + 1 + up, i + up]), uv)


def sphere(node: Node) -> Geometry:
    unit, faces, uv = unit_sphere()
    return Geometry(node.vector("center", (0, 0, 0)) + node.number("radius", 1.0) * unit, faces, uv, own_normals=False)


ANALYTIC = {"rectangle": rectangle, "cube": cube, "disk": disk, "cylinder": cylinder, "sphere": sphere}
