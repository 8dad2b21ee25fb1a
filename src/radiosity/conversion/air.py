"""Surfaces that light does not meet: lines pass them on both sides, and they do not shine."""

from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..scene.model import Back, Scene
from .pieces import called
from .told import Told

KEPT = (".toml",)  # formats that hold such surfaces


def without_air(scene: Scene, path: Path, told: Told) -> Scene:
    """Return a scene without such surfaces, unless the format holds them: opaque ones must not take their place.

    Raises:
        OutputError: nothing would be left.
    """
    air = np.zeros(scene.n_faces, bool)
    if path.suffix.lower() not in KEPT:
        air = (scene.back == Back.OPEN) & ~(scene.emission > 0).any(axis=1)
        if scene.emission_paint is not None:
            air &= ~scene.emission_paint.painted
    if not air.any():
        return scene
    if air.all():
        raise OutputError(f"{path}: nothing would be in it: lines pass all surfaces, and none of them shines; write a .toml")
    told.add("surfaces that lines pass on both sides are left out", called(scene, air))
    return scene.take(~air)
