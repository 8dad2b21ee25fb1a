"""The ball about a scene: what shines from far away sends lines through it."""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...sampling.global_lines import across
from ...sampling.hemisphere import turn
from ...scene.model import Scene

MARGIN = 4e-6  # of the largest coordinates: no rounding of single precision leaves a point of the scene outside


@dataclass(frozen=True, eq=False)
class Ball:
    """The ball about the middle of a scene's box.

    Attributes:
        centre: (3,) float64, m.
        radius: m.
    """

    centre: np.ndarray
    radius: float

    @staticmethod
    def about(scene: Scene, also: np.ndarray | None = None) -> "Ball":
        """Make the ball that holds all faces of a scene, and other points, (n, 3) m."""
        used = scene.vertices[np.unique(scene.faces[scene.faces >= 0])]
        middle = scene.bounds.mean(axis=0)
        points = used if also is None else np.concatenate([used, also])
        radius = float(np.linalg.norm(points - middle, axis=1).max())
        return Ball(middle, radius + MARGIN * (radius + float(np.linalg.norm(middle - scene.centre))))

    @property
    def disc(self) -> float:
        """The area of the disc across a direction through which all lines go that can meet the scene, m²."""
        return np.pi * self.radius**2

    def placed(self, geometry: Any) -> "PlacedBall":
        """Return it in the BVH's coordinates, on the device."""
        Float = geometry.device.types.Float
        centre = [dr.opaque(Float, float(value)) for value in geometry.bvh.place(self.centre)]
        return PlacedBall(geometry.device.types.Array3f(*centre), dr.opaque(Float, float(self.radius * geometry.bvh.scale)))


@dataclass(frozen=True)
class PlacedBall:
    """A ball on the device; its numbers are arrays, so that other scenes need no other kernels."""

    centre: Any
    radius: Any

    def enter(self, direction: Any, first: Any, second: Any) -> Any:
        """Return where lines of a direction begin; called in a kernel.

        That is a uniform point of the disc across the direction that touches the ball, before anything of the scene.

        Args:
            first, second: two numbers in [0, 1).
        """
        cosine, sine = turn(first)
        away = dr.sqrt(second) * self.radius
        return across(direction, cosine * away, sine * away) - direction * self.radius + self.centre

    def back(self, point: Any, direction: Any) -> Any:
        """Return where lines of a direction through points enter the ball; called in a kernel."""
        way = point - self.centre
        along = dr.dot(way, direction)
        rest = along * along - dr.squared_norm(way) + self.radius * self.radius
        return point - direction * (along + dr.sqrt(dr.maximum(rest, 0)))

    def away(self, direction: Any) -> tuple[Any, Any]:
        """Return lines that leave the scene at once; called in a kernel."""
        return self.centre - direction * self.radius, -direction
