"""The direction that is up in a .toml scene: as its sky says, or by its geometry files."""

from pathlib import Path
from typing import Any

import numpy as np

from ....errors import shown
from ...assemble import warn
from ...lights.axes import up_of
from ...model import Scene
from ...up import Z_UP, up_axis

Y_UP = (".glb", ".gltf")  # formats in which y is up; in others of `scene.up.Y_UP` it mostly is


def upward_of(asked: Any, scene: Scene, source: Path) -> np.ndarray:
    """Return the unit direction that is up, (3,).

    It is what [sky] or [sun] say, or that of the formats of all geometry files, or what the scene's surfaces look like. Files of
    formats with other axes up, in one scene, are told where luminaires, sensors or a sky depend on it.
    """
    for entry in (asked.sky, asked.sun):
        if entry is not None and entry.up is not None:
            return up_of(entry.up)
    files = {entry.file: Path(entry.file).suffix.lower() for entry in asked.geometry}
    of_z, of_y = ([name for name, suffix in files.items() if suffix in known] for known in (Z_UP, Y_UP))
    if len(of_z) == len(files):
        axis = "z"
    elif len(of_y) == len(files):
        axis = up_axis(scene, of_y[0])
    else:
        axis = up_axis(scene)
    if of_z and of_y and (asked.luminaire or asked.sensors or asked.sky or asked.sun):
        text = f"in {shown(of_z)} z is up, and in {shown(of_y)} y; no file is turned, and {axis} is taken as up"
        warn(f"{source}: {text}: turn one of them, or give up = in [sky]")
    return up_of(axis)
