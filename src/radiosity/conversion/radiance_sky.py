"""Suns and uniform skies as sources of Radiance."""

from collections.abc import Iterator

import numpy as np

from ..scene.lights.model import Lights
from ..scene.lights.sky import Sky
from .told import Told

LEAST = 0.01  # degrees: the disc of a sun that has none


def far_lights(lights: Lights, watts: float, told: Told) -> Iterator[str]:
    """Yield statements of suns and of the two halves of a sky.

    Args:
        watts: what radiances are multiplied with.
    """
    for number, sun in enumerate(lights.suns):
        if not sun.diameter:
            told.add(f"suns without a disc get one of {LEAST:g} degrees", [sun.name])
        angle = float(sun.diameter) or LEAST
        radiance = sun.irradiance * watts / (np.pi * np.sin(np.radians(angle) / 2) ** 2)
        yield _source(f"sun_{number}", "light", radiance, sun.direction, angle)
    if lights.sky is not None:
        yield from _sky(lights.sky, watts, told)


def _sky(sky: Sky, watts: float, told: Told) -> Iterator[str]:
    half = len(sky.radiance) // 2
    parts = [sky.radiance[half:], sky.radiance[:half]]
    if any((part != part[0, 0]).any() for part in parts):
        told.add("skies that are not uniform are left out; gensky and gendaylit of Radiance write them", [sky.name])
        return
    for name, part, up in zip(("sky", "ground"), parts, (sky.axes[2], -sky.axes[2]), strict=True):
        if part.any():
            yield _source(name, "glow", part[0, 0] * watts, up, 180.0)


def _source(name: str, kind: str, radiance: np.ndarray, direction: np.ndarray, angle: float) -> str:
    """A source and its material; a glow has a radius, too."""
    values = " ".join(f"{value!r}" for value in np.broadcast_to(radiance, (3,)).tolist())
    numbers = f"4 {values} 0" if kind == "glow" else f"3 {values}"
    place = " ".join(f"{value!r}" for value in [*np.asarray(direction, float).tolist(), angle])
    return f"\nvoid {kind} {name}_light\n0\n0\n{numbers}\n{name}_light source {name}\n0\n0\n4 {place}\n"
