"""Adding lights to a scene: their bands become those of the scene, and watts and lumens are kept apart."""

from dataclasses import replace
from functools import reduce
from typing import Any

import numpy as np

from ...errors import SceneError
from ..back import Back
from .build import LUMINANCE
from .luminaire import Luminaire
from .model import Lights
from .sky import Sky
from .sun import Sun


def with_lights(scene: Any, lights: Lights) -> Any:
    """Return a scene with more lights.

    Raises:
        SceneError: some light is in W and other light in lm, there are two skies, or bands that the scene has not.
    """
    luminaires = tuple(in_bands(one, scene.n_bands) for one in lights.luminaires)
    both = merged(scene.lights, replace(lights, luminaires=luminaires), scene.source)
    lit = ((scene.emission > 0).any(axis=1)) | ((scene.back == Back.RADIATES) & (scene.back_emission > 0).any(axis=1))
    emitting = [scene.names[i] for i in np.unique(scene.surface[lit])]
    photometric = photometric_with(both, emitting, scene.photometric if emitting or scene.photometric else None, scene.source)
    return replace(scene, lights=both, photometric=photometric)


def all_lights(scenes: list, n_bands: int, source: str) -> Lights:
    """Return the lights of several scenes, for a scene of so many bands."""
    lights = reduce(lambda one, other: merged(one, other, source), (scene.lights for scene in scenes))
    return replace(lights, luminaires=tuple(in_bands(one, n_bands) for one in lights.luminaires))


def scaled(lights: Lights, factor: float) -> Lights:
    """Return lights of a file whose unit of length is another one: they move, and send what they sent."""
    moved = tuple(replace(one, position=one.position * factor, size=one.size * factor) for one in lights.luminaires)
    return replace(lights, luminaires=moved, openings=None if lights.openings is None else lights.openings * factor)


def in_bands(luminaire: Luminaire, n_bands: int) -> Luminaire:
    """Return a luminaire with a power for each band of a scene: a grey one takes the photopic mean of a colour.

    Raises:
        SceneError: its bands are others.
    """
    power = np.atleast_1d(np.asarray(luminaire.power, np.float64))
    if len(power) == 1:
        power = power.repeat(n_bands)
    elif len(power) == 3 and n_bands == 1:
        power = np.array([LUMINANCE @ power])
    if len(power) != n_bands:
        raise SceneError(f"luminaire '{luminaire.name}' has {len(power)} bands, and the scene {n_bands}; give power one number")
    return replace(luminaire, power=power)


def photometric_with(lights: Lights, emitting: list[str], photometric: bool | None, source: str) -> bool:
    """Return whether a scene with these lights is photometric.

    Args:
        emitting: names of surfaces that emit.
        photometric: the unit of what surfaces emit, or of other lights; None: nothing says it.
        source: of the scene, for messages.

    Raises:
        SceneError: some light is in W and other light in lm.
    """
    in_lumens, in_watts = ([_called(one) for one in lights.all if one.photometric is unit] for unit in (True, False))
    if in_lumens and in_watts:
        raise SceneError(f"{source}: {in_lumens[0]} is in lm, and {in_watts[0]} in W; give all lights in lm, or all in W")
    what = f"surface '{emitting[0]}'" if emitting else "the scene"
    if photometric is False and in_lumens:
        how = "where emission is in lm/m² and power in lm, set photometric = true (in a .toml, or Scene.from_arrays)"
        raise SceneError(f"{source}: {what} is in W, and {in_lumens[0]} in lm; give both in one unit: {how}")
    if photometric and in_watts:
        raise SceneError(f"{source}: {what} is in lm, and {in_watts[0]} in W; give both in one unit")
    return bool(in_lumens) if lights else bool(photometric)


def _called(light: Luminaire | Sun | Sky) -> str:
    kind = {Luminaire: "luminaire", Sun: "sun", Sky: "sky"}[type(light)]
    return kind if light.name in ("", kind) else f"{kind} '{light.name}'"


def merged(one: Lights, other: Lights, source: str) -> Lights:
    """Return the lights of both.

    Raises:
        SceneError: both have a sky.
    """
    if one.sky is not None and other.sky is not None:
        raise SceneError(f"{source}: has two skies, '{one.sky.name}' and '{other.sky.name}'; keep one")
    openings = [x for x in (one.openings, other.openings) if x is not None]
    return Lights(
        one.luminaires + other.luminaires,
        one.suns + other.suns,
        one.sky if other.sky is None else other.sky,
        np.concatenate(openings) if openings else None,
    )
