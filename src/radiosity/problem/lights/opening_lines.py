"""Lines through openings, and lines that leave the scene in place of those that another row fires."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from .ball import Ball
from .openings import NONE, Openings


@dataclass(eq=False)
class OpeningLines:
    """Lines from far away, and the openings that they cross, whatever is in the way.

    Attributes:
        corners: (n, 4, 3) float64, m, around each opening; a triangle repeats its last corner.
        ball: about the scene and the openings.
    """

    corners: np.ndarray
    ball: Ball
    _ball: Any = field(default=None, init=False)
    _openings: Any = field(default=None, init=False)

    @cached_property
    def area(self) -> np.ndarray:
        """The area of each, (n,) m²."""
        flat = (self.corners[:, 2] == self.corners[:, 3]).all(axis=1)
        return np.linalg.norm(self._cross, axis=1) * np.where(flat, 0.5, 1.0)

    @cached_property
    def normal(self) -> np.ndarray:
        """The unit normal of each, (n, 3)."""
        return self._cross / np.linalg.norm(self._cross, axis=1, keepdims=True)

    @cached_property
    def _cross(self) -> np.ndarray:
        return np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 3] - self.corners[:, 0])

    def prepare(self, geometry: Any) -> None:
        """Make what kernels read."""
        self._ball, self._openings = self.ball.placed(geometry), Openings(geometry, self.corners)
        self._openings.prepare()

    def without(self, line: tuple[Any, Any], active: Any) -> tuple[Any, Any]:
        """Return lines, but those away from the scene that cross an opening; called in a kernel."""
        found, _, _ = self._openings.nearest(*line, active)
        return self._sent(found == NONE, *line)

    def through(self, number: Any, place: tuple[Any, Any], direction: Any, fired: Any, active: Any) -> tuple[Any, Any]:
        """Return lines through openings, those away from the scene that cross another opening first; called in a kernel.

        Args:
            number: UInt32, of the opening.
            place: two numbers in [0, 1).
            direction: three floats, of unit length.
            fired: says of the cosine between line and normal, not negative, whether the line is one.
        """
        point, normal = self._openings.point(number, *place, active)
        origin = self._ball.back(point, direction)
        found, _, _ = self._openings.nearest(origin, direction, active)
        return self._sent((found == number) & fired(dr.abs(dr.dot(normal, direction))), origin, direction)

    def _sent(self, fired: Any, origin: Any, direction: Any) -> tuple[Any, Any]:
        start, way = self._ball.away(direction)
        return dr.select(fired, origin, start), dr.select(fired, direction, way)
