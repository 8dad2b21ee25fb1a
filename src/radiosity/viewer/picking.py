"""What a ray from the eye meets: the first patch that the page shows."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from ..image.lookup import Lookup
from ..patches import Patches
from ..scene import Back

RIM = 1e-9  # of face coordinates: a ray through an edge meets one of its faces


@dataclass(frozen=True)
class Cut:
    """A plane that cuts away what lies beyond it: points x with x[axis] > at, or below it where ``below``; in metres."""

    axis: int
    at: float
    below: bool = False

    def beyond(self, points: np.ndarray) -> np.ndarray:
        """Return how far points, (..., 3), lie beyond the plane, (...), m; negative: they are shown."""
        distance = points[..., self.axis] - self.at
        return -distance if self.below else distance


def pick(patches: Patches, origin, direction, hidden: np.ndarray, cut: Cut | None = None) -> tuple[int, np.ndarray] | None:
    """Return the first patch on a ray, and where it is met, (3,) m; None where there is none.

    Args:
        patches: of the scene.
        origin, direction: (3,) of the ray.
        hidden: (n_surfaces,) bool, surfaces that are not shown.
        cut: the plane that cuts away what lies beyond it.
    """
    scene = patches.scene
    origin, direction = np.asarray(origin, np.float64), np.asarray(direction, np.float64)
    corner, first, second = scene.frames
    normal = np.cross(first, second)
    slope, square = normal @ direction, np.einsum("ij,ij->i", normal, normal)
    shown = ~hidden[scene.surface] & ((slope < 0) | ((slope > 0) & (scene.back == Back.RADIATES)))
    with np.errstate(divide="ignore", invalid="ignore"):
        along = np.einsum("ij,ij->i", corner - origin, normal) / slope
        point = origin + along[:, None] * direction
        u = np.einsum("ij,ij->i", np.cross(point - corner, second), normal) / square
        v = np.einsum("ij,ij->i", np.cross(first, point - corner), normal) / square
        inside = (u >= -RIM) & (v >= -RIM) & (np.where(scene.is_quad, np.maximum(u, v), u + v) <= 1 + RIM)
        met = shown & inside & (along > 0)
        if cut is not None:
            met &= cut.beyond(point) <= 0
    if not met.any():
        return None
    face = int(np.argmin(np.where(met, along, np.inf)))
    hit = SimpleNamespace(face=[face], front=[bool(slope[face] < 0)], u=[u[face]], v=[v[face]])
    return int(Lookup(patches, np.zeros((len(patches), 0)), smooth=False).patch(hit)[0]), point[face]
