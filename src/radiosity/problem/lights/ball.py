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
    def about(scene: Scene) -> "Ball":
        """Make the ball that holds all faces of a scene."""
        middle = scene.bounds.mean(axis=0)
        used = scene.vertices[np.unique(scene.faces[scene.faces >= 0])]
        radius = float(np.linalg.norm(used - middle, axis=1).max())
        return Ball(middle, radius + MARGIN * (radius + float(np.linalg.norm(middle - scene.centre))))

    @property
    def disc(self) -> float:
        """The area of the disc across a direction through which all lines go that can meet the scene, m²."""
        return np.pi * self.radius**2

    def enter(self, geometry: Any, direction: Any, first: Any, second: Any) -> Any:
        """Return where lines of a direction begin, in the BVH's coordinates; called in a kernel.

        That is a uniform point of the disc across the direction that touches the ball, before anything of the scene.

        Args:
            first, second: two numbers in [0, 1).
        """
        x, y, z = (float(value) for value in geometry.bvh.place(self.centre))
        radius = float(self.radius * geometry.bvh.scale)
        cosine, sine = turn(first)
        away = dr.sqrt(second) * radius
        return across(direction, cosine * away, sine * away) - direction * radius + type(direction)(x, y, z)
