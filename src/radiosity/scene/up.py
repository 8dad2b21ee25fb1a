"""The direction that is up in a scene."""

from pathlib import PurePath

import numpy as np

from .model import Scene

Y_UP = (".glb", ".gltf", ".obj", ".xml")  # formats whose scenes are mostly modelled with y upwards
Z_UP = (".hbjson", ".ifc", ".rad")  # formats in which z is up
CLEARLY = 1.3  # times as much level area along the other axis speaks against a format's habit


def up_vector(scene: Scene) -> tuple[float, float, float]:
    """Return the unit vector along the axis that is up."""
    return (0.0, 1.0, 0.0) if up_axis(scene) == "y" else (0.0, 0.0, 1.0)


def up_axis(scene: Scene, source: str | None = None) -> str:
    """Return ``y`` or ``z``, the axis that is up.

    It is the main direction of the first camera's up, or else what is usual in the scene's file format, unless there is clearly
    more area of floors, ceilings and table tops along the other axis.

    Args:
        source: the file whose format counts; by default that of the scene.
    """
    suffix = PurePath(scene.source if source is None else source).suffix.lower()
    if scene.cameras:
        up = np.abs(np.asarray(scene.cameras[0].up, np.float64))
        return "y" if up[1] > up[2] else "z"
    if suffix in Z_UP:
        return "z"
    level = (scene.area[:, None] * (np.abs(scene.normal) > 0.999)).sum(axis=0)
    if suffix in Y_UP:
        return "z" if level[2] > CLEARLY * level[1] else "y"
    return "y" if level[1] > CLEARLY * level[2] else "z"
