"""What reports say of the sky, the suns and the openings of a scene."""

from collections.abc import Iterator

import numpy as np

from ..model import Scene
from .axes import place_of
from .sun import Sun


def daylight(scene: Scene) -> Iterator[str]:
    """Yield a line for the sky, each sun, and the openings."""
    sky, unit = scene.lights.sky, scene.unit
    if sky is not None:
        below = sky.radiance[: len(sky.radiance) // 2].mean(axis=(0, 1))
        ground = f"ground {_bands(below * np.pi)} {unit}" if below.any() else "ground black"
        named = "" if sky.name == "sky" else f"'{sky.name}', "
        kind = f"{sky.kind}, " if sky.kind else ""
        up = np.round(sky.axes[2], 3) + 0.0
        yield f"sky       {named}{kind}{_bands(sky.horizontal)} {unit} on the horizontal; {ground}; up is {_point(up)}"
    for sun in scene.lights.suns:
        named = "" if sun.name == "sun" else f"'{sun.name}', "
        yield f"sun       {named}{_bands(sun.irradiance)} {unit} across its light, {_where(sun, scene)}"
    if scene.lights.openings is not None:
        corners = scene.lights.openings
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        area = area * np.where((corners[:, 2] == corners[:, 3]).all(axis=1), 0.5, 1.0)
        yield f"openings  {len(corners)}, {area.sum():.4g} m²"


def _where(sun: Sun, scene: Scene) -> str:
    sky = scene.lights.sky
    if sky is None:
        return f"towards {_point(np.round(sun.direction, 4) + 0.0)}"
    altitude, azimuth = place_of(sky.axes, sun.direction)
    return f"altitude {altitude:.1f}, azimuth {azimuth:.1f} degrees"


def _bands(values: np.ndarray) -> str:
    texts = [f"{value:.4g}" for value in values]
    return texts[0] if len(set(texts)) == 1 else " / ".join(texts)


def _point(values: np.ndarray) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"
