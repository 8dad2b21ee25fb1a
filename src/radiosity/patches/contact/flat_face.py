"""A face in its own plane, and the pieces into which straight cuts divide it."""

import numpy as np

from ...scene.model import Scene
from . import convex

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


class Flat:
    """A face in its own plane, in metres: cuts are straight there as in face coordinates, and distances are true."""

    def __init__(self, scene: Scene, face: int):
        _, first, second = (edge[face] for edge in scene.frames)
        axis = first / np.linalg.norm(first)
        across = np.cross(scene.normal[face], axis)
        self.axes = np.array([[first @ axis, first @ across], [second @ axis, second @ across]])
        self.outline = self.plane(SQUARE if scene.is_quad[face] else SQUARE[[0, 1, 3]])

    def plane(self, uv: np.ndarray) -> np.ndarray:
        return uv @ self.axes

    def face(self, points: np.ndarray) -> np.ndarray:
        return np.clip(points @ np.linalg.inv(self.axes), 0.0, 1.0)


class Pieces:
    """The pieces of a face so far, with boxes about them, so that a line looks only at pieces near it."""

    def __init__(self, flat: Flat):
        self.flat = flat
        self.polygons = [flat.outline]
        self.boxes = _box(flat.outline)[None]
        self.trapezoids = False  # see `convex.parts`

    def cut(self, ends: np.ndarray, least: float) -> int:
        """Cut the pieces that a segment passes through, and return how many more there are.

        Args:
            ends: (2, 2) face coordinates. least: metres; shorter parts of the segment, and thinner strips, do not count.
        """
        return self._put(self._halves(ends, least))

    def cut_at_shadow(self, ends: np.ndarray, least: float, most: int) -> int:
        """Cut likewise along a shadow's edge, and return how many patches that adds; no cut where they are more than ``most``."""
        found = self._halves(ends, least)
        cost = sum(len(convex.parts(part, True)) for _, two in found for part in two)
        cost -= sum(len(convex.parts(self.polygons[row], True)) for row, _ in found)
        if not found or cost > most:
            return 0
        self.trapezoids = True
        self._put(found)
        return cost

    def _halves(self, ends: np.ndarray, least: float) -> list[tuple[int, tuple[np.ndarray, np.ndarray]]]:
        """Return the pieces that a segment passes through, the last ones first, and the two parts of each."""
        line = self.flat.plane(ends)
        low, high = _box(line)
        near = np.flatnonzero(((self.boxes[:, 0] <= high) & (self.boxes[:, 1] >= low)).all(axis=1))
        found = ((row, _cut(self.polygons[row], line, least)) for row in (near[::-1]).tolist())
        return [(row, two) for row, two in found if two is not None]

    def _put(self, found: list) -> int:
        """Put parts in the places of pieces, and return how many more pieces there are."""
        for row, two in found:
            self.polygons[row : row + 1] = two
            self.boxes = np.concatenate([self.boxes[:row], [_box(part) for part in two], self.boxes[row + 1 :]])
        return len(found)

    def parts(self) -> list[list[np.ndarray]]:
        """Return the triangles and parallelograms of each piece, in face coordinates."""
        return [[self.flat.face(part) for part in convex.parts(polygon, self.trapezoids)] for polygon in self.polygons]


def _box(points: np.ndarray) -> np.ndarray:
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _cut(piece: np.ndarray, line: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the two parts of a polygon where a segment passes through it, or None."""
    one, two = line
    if convex.inside(piece, one, two, least) is None:
        return None
    return convex.cut(piece, one, (two - one) / np.hypot(*(two - one)), least)
