"""Random shapes, transformations, colours and images that the files of all formats are made of."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Sample:
    """A file and what is in it.

    Attributes:
        format: a key of ``readers.FORMATS``.
        features: what was drawn for it.
    """

    path: Path
    format: str
    features: set[str] = field(default_factory=set)


@dataclass(frozen=True, eq=False)
class Shape:
    """Flat polygons.

    Attributes:
        points: (n, 3).
        polygons: corner numbers of each, counterclockwise from the front.
        uv: (n, 2).
    """

    points: np.ndarray
    polygons: list[list[int]]
    uv: np.ndarray

    def moved(self, matrix: np.ndarray) -> "Shape":
        return Shape(self.points @ matrix[:3, :3].T + matrix[:3, 3], self.polygons, self.uv)

    def triangles(self) -> np.ndarray:
        """(m, 3) corner numbers; polygons of this module are convex unless said otherwise, and cut from their first corner."""
        return np.array([(p[0], p[i], p[i + 1]) for p in self.polygons for i in range(1, len(p) - 1)])


class Draw(np.random.Generator):
    """A generator of one file's numbers that notes the features it drew."""

    def __init__(self, kind: str, seed: int):
        super().__init__(np.random.Philox(key=[seed, sum(kind.encode())]))
        self.features: set[str] = set()

    def has(self, feature: str, chance: float = 0.3) -> bool:
        """Whether a feature is drawn; it is noted."""
        drawn = bool(self.random() < chance)
        if drawn:
            self.features.add(feature)
        return drawn

    def one(self, *values):
        """One of the values."""
        return values[int(self.integers(len(values)))]

    def color(self, low: float = 0.05, high: float = 0.9) -> list[float]:
        """Three numbers, often equal."""
        values = [round(float(v), 4) for v in self.uniform(low, high, 3)]
        return values if self.random() < 0.6 else values[:1] * 3

    def image(self, width: int | None = None) -> np.ndarray:
        """(height, width, 3) uint8, small."""
        shape = (int(self.integers(1, 9)), int(self.integers(1, 9)), 3)
        return self.integers(0, 240, shape).astype(np.uint8)

    def quaternion(self) -> list[float]:
        values = self.normal(size=4)
        return [float(v) for v in values / np.linalg.norm(values)]

    def matrix(self, *, mirror: bool = True) -> np.ndarray:
        """(4, 4) rotation, uneven scale and move; mirrors are noted."""
        scale = self.uniform(0.4, 2.0, 3)
        if self.random() < 0.4:
            scale[:] = scale[0]
        elif len(set(scale)) > 1:
            self.features.add("uneven scale")
        if mirror and self.has("mirror", 0.25):
            scale[int(self.integers(3))] *= -1
        result = np.eye(4)
        result[:3, :3] = rotation(self.quaternion()) * scale
        result[:3, 3] = self.uniform(-3, 3, 3)
        return result

    def shape(self) -> Shape:
        """A box, a pyramid, a grid or a fan of triangles, sheared at random."""
        kind = self.one(box, pyramid, grid, fan, polygon)
        made = kind(self)
        shear = np.eye(4)
        shear[:3, :3] += self.uniform(-0.3, 0.3, (3, 3))
        # texture coordinates of a parallelogram are those of its corners: only affine ones are alike however it is cut
        skewed = self.has("skewed coordinates", 0.1)
        uv = made.uv if skewed else (made.points @ self.uniform(-1, 1, (3, 2)) + self.uniform(-1, 1, 2)).round(4)
        return Shape(made.points, made.polygons, uv).moved(shear)


def rotation(quaternion) -> np.ndarray:
    """(3, 3) of a unit quaternion x, y, z, w."""
    x, y, z, w = quaternion
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def box(draw: Draw) -> Shape:
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Shape(corners, quads, draw.uniform(-1, 2, (8, 2)).round(3))


def pyramid(draw: Draw) -> Shape:
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.4, 0.5, 1.2)])
    return Shape(corners, [[3, 2, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], draw.uniform(0, 1, (5, 2)).round(3))


def grid(draw: Draw) -> Shape:
    columns, rows = int(draw.integers(1, 4)), int(draw.integers(1, 4))
    x, y = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    points = np.column_stack([x.ravel(), y.ravel(), 0.3 * x.ravel()])
    lower = [j * (columns + 1) + i for j in range(rows) for i in range(columns)]
    quads = [[a, a + 1, a + columns + 2, a + columns + 1] for a in lower]
    return Shape(points, quads, np.column_stack([x.ravel() * 2, y.ravel() * 1.5]))


def fan(draw: Draw) -> Shape:
    count = int(draw.integers(3, 8))
    points = np.vstack([np.zeros(3), draw.normal(size=(count + 1, 3))])
    return Shape(points, [[0, i, i + 1] for i in range(1, count + 1)], draw.uniform(0, 1, (count + 2, 2)).round(3))


def polygon(draw: Draw) -> Shape:
    """A convex one of five to eight corners."""
    count = int(draw.integers(5, 9))
    angle = np.sort(np.linspace(0, 2 * np.pi, count, endpoint=False) + draw.uniform(0, 0.5, count))
    points = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count)])
    return Shape(points, [list(range(count))], points[:, :2] / 2 + 0.5)


def star(draw: Draw) -> Shape:
    """A concave polygon."""
    count = 2 * int(draw.integers(3, 6))
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    radius = np.where(np.arange(count) % 2, 0.35, 1.0)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(count)])
    return Shape(points, [list(range(count))], points[:, :2] / 2 + 0.5)
