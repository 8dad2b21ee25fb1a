"""Lights that files hold, given to the scenes of those files."""

from dataclasses import replace

import numpy as np

from ...errors import SceneError
from ..lights.model import Lights
from ..model import Scene


def with_distant_lights(scene: Scene, lights: Lights) -> Scene:
    """Return a scene with suns and a sky; a grey scene gets three bands where they have a colour."""
    widths = [len(sun.irradiance) for sun in lights.suns] + ([] if lights.sky is None else [lights.sky.radiance.shape[2]])
    for light in lights.suns:
        values(light.irradiance, f"sun '{light.name}'", scene.source)
    if lights.sky is not None:
        values(lights.sky.radiance, f"sky '{lights.sky.name}'", scene.source)
    if max(widths, default=1) > scene.n_bands:
        keys = ("reflectance", "emission", "back_reflectance", "back_emission")
        wide = {key: np.repeat(getattr(scene, key), 3, axis=1) for key in keys}
        scene = replace(scene, bands=("red", "green", "blue"), **wide)
    return replace(scene, lights=lights) if lights else scene


def values(light: np.ndarray, what: str, source: str) -> None:
    """Refuse light that is negative or not finite.

    Raises:
        SceneError: it is.
    """
    if not (np.isfinite(light).all() and (light >= 0).all()):
        raise SceneError(f"{source}: {what} has the radiance {np.ravel(light)[:3].tolist()}; it must be finite and not negative")
