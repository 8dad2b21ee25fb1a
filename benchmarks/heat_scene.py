"""The scene of ``make bench-heat``: a closed box with a cylinder in it, cut into as many flat faces as are asked for.

The box is 4 x 3 x 2.5 m. The cylinder, a prism of 32 sides, floats in it and hides walls from each other. Only numpy is used,
so that a process of a peer loads nothing of this package.
"""

from dataclasses import dataclass

import numpy as np

SIZE = np.array([4.0, 3.0, 2.5])
CENTER, RADIUS, BOTTOM, TOP = np.array([1.8, 1.4]), 0.5, 0.3, 1.9
SIDES = 32
NAMES = ("west", "east", "south", "north", "floor", "ceiling", "side", "ends")


@dataclass(frozen=True)
class Cut:
    """How finely faces are cut: a wall into n x n, a side of the cylinder into a x b, a triangle of its ends into c x c."""

    n: int
    a: int = 1
    b: int = 1
    c: int = 1

    @property
    def faces(self) -> int:
        """The number of flat faces."""
        return 6 * self.n**2 + SIDES * (self.a * self.b + 2 * self.c**2)

    def finer(self, times: int) -> "Cut":
        """Each face cut into times x times."""
        return Cut(*(times * value for value in (self.n, self.a, self.b, self.c)))


SURFACES = Cut(1)
CUTS = {"544": Cut(8, 1, 3, 1), "4608": Cut(24, 2, 9, 3), "100000": Cut(120, 5, 45, 10)}
STEPS = {"4608": 96}  # of the rows of a scene every so-many-th is judged; of other scenes all are


@dataclass(frozen=True)
class Mesh:
    """Flat faces that look into the enclosure.

    Attributes:
        corners: (m, 4, 3) metres, counterclockwise seen from inside; a triangle repeats its last corner.
        surface: (m,) index into `NAMES`.
    """

    corners: np.ndarray
    surface: np.ndarray

    @property
    def triangle(self) -> np.ndarray:
        """Which faces are triangles, (m,)."""
        return (self.corners[:, 3] == self.corners[:, 2]).all(axis=1)

    @property
    def area(self) -> np.ndarray:
        """The area of each face, (m,) m²."""
        one, two = self.corners[:, 2] - self.corners[:, 0], self.corners[:, 3] - self.corners[:, 1]
        return np.linalg.norm(np.cross(one, two), axis=1) / 2


def mesh(cut: Cut) -> Mesh:
    """Cut the scene; `parents` says which face of a coarser cut a face lies in."""
    parts = [(corners, number) for number, corners in enumerate(_walls())]
    pieces = [(_quads(corners, cut.n, cut.n), number) for corners, number in parts]
    turn = np.linspace(0, 2 * np.pi, SIDES + 1)[:-1]
    ring = CENTER + RADIUS * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    low, high = (np.column_stack([ring, np.full(SIDES, z)]) for z in (BOTTOM, TOP))
    for i in range(SIDES):
        j = (i + 1) % SIDES
        pieces.append((_quads(np.array([low[i], low[j], high[j], high[i]]), cut.a, cut.b), 6))
        pieces.append((_triangles(np.array([[*CENTER, BOTTOM], low[j], low[i]]), cut.c), 7))
        pieces.append((_triangles(np.array([[*CENTER, TOP], high[i], high[j]]), cut.c), 7))
    return Mesh(np.concatenate([piece for piece, _ in pieces]), np.repeat([s for _, s in pieces], [len(p) for p, _ in pieces]))


def parents(cut: Cut, times: int) -> np.ndarray:
    """The face of ``mesh(cut)`` that each face of ``mesh(cut.finer(times))`` lies in."""
    if times == 1:
        return np.arange(cut.faces)
    quads, triangles = [_grid(a, b, times) for a, b in ((cut.n, cut.n), (cut.a, cut.b))], _small(cut.c, times)
    kinds = [quads[0]] * 6 + [quads[1], triangles, triangles] * SIDES
    sizes = [cut.n**2] * 6 + [cut.a * cut.b, cut.c**2, cut.c**2] * SIDES
    return np.concatenate([kind + first for kind, first in zip(kinds, np.cumsum([0, *sizes[:-1]]), strict=True)])


def _walls() -> list[np.ndarray]:
    """Corners of the walls in the order of `NAMES`, seen counterclockwise from inside."""
    walls = []
    for axis in range(3):
        one, two = np.eye(3)[(axis + 1) % 3] * SIZE, np.eye(3)[(axis + 2) % 3] * SIZE
        near = np.array([0 * one, one, one + two, two])
        walls += [near, near[::-1] + np.eye(3)[axis] * SIZE]
    return walls


def _quads(corners: np.ndarray, a: int, b: int) -> np.ndarray:
    u, v = np.meshgrid(np.arange(a) / a, np.arange(b) / b, indexing="ij")
    places = [(u, v), (u + 1 / a, v), (u + 1 / a, v + 1 / b), (u, v + 1 / b)]
    one, two = corners[1] - corners[0], corners[3] - corners[0]
    return np.stack([corners[0] + x.reshape(-1, 1) * one + y.reshape(-1, 1) * two for x, y in places], axis=1)


def _triangles(corners: np.ndarray, c: int) -> np.ndarray:
    one, two = (corners[1] - corners[0]) / c, (corners[2] - corners[0]) / c
    found = []
    for i, j, up in _cells(c):
        three = [(i, j), (i + 1, j), (i, j + 1)] if up else [(i + 1, j), (i + 1, j + 1), (i, j + 1)]
        found.append([corners[0] + x * one + y * two for x, y in (*three, three[-1])])
    return np.array(found)


def _cells(c: int) -> list[tuple[int, int, bool]]:
    """Column, row and kind of the small triangles of a triangle, in order."""
    return [(i, j, up) for i in range(c) for j in range(c - i) for up in (True, False) if up or i + j < c - 1]


def _grid(a: int, b: int, times: int) -> np.ndarray:
    u, v = np.meshgrid(np.arange(a * times) // times, np.arange(b * times) // times, indexing="ij")
    return (u * b + v).ravel()


def _small(c: int, times: int) -> np.ndarray:
    number = {cell: place for place, cell in enumerate(_cells(c))}
    found = []
    for i, j, up in _cells(c * times):
        x, y = ((i + 1 / 3) / times, (j + 1 / 3) / times) if up else ((i + 2 / 3) / times, (j + 2 / 3) / times)
        column, row = int(x), int(y)
        found.append(number[column, row, bool(x - column + y - row < 1)])
    return np.array(found)
