"""Points for formats in which z is up."""

from collections.abc import Callable

import numpy as np

from ..scene.model import Scene
from ..scene.up import up_axis
from .told import Told


def upright(scene: Scene, told: Told, models: str) -> Callable[[np.ndarray], np.ndarray]:
    """Return what turns points (n, 3) of a scene whose y is up, which is told, and leaves those of others.

    Args:
        models: what the format's files are called, for people.
    """
    if up_axis(scene) != "y":
        return lambda points: points
    told.add(f"{models} are z-up: the scene, whose y is up, is turned", [scene.source])
    return lambda points: points[:, [0, 2, 1]] * [1, -1, 1]
