"""Adding lights to a scene: their bands become those of the scene, and watts and lumens are kept apart."""

from dataclasses import replace
from functools import reduce
from typing import Any

import numpy as np

from ...errors import SceneError
from ..back import Back
from ..photopic import PHOTOPIC
from .luminaire import Luminaire
from .model import Lights
from .sky import Sky
from .sun import Sun

VALUES = ("reflectance", "emission", "back_reflectance", "back_emission")  # of a scene, (n_faces, n_bands)
PAINTS = ("reflectance_paint", "emission_paint")


def with_lights(scene: Any, lights: Lights) -> Any:
    """Return a scene with more lights. A grey one becomes coloured where a light has a colour.

    Raises:
        SceneError: some light is in W and other light in lm, there are two skies, or bands that the scene has not.
    """
    if scene.n_bands == 1 and any((values != values[..., :1]).any() for values in map(_values, lights.all)):
        scene = _in_color(scene)
    both = merged(scene.lights, in_bands(lights, scene.n_bands), scene.source)
    lit = ((scene.emission > 0).any(axis=1)) | ((scene.back == Back.RADIATES) & (scene.back_emission > 0).any(axis=1))
    emitting = [scene.names[i] for i in np.unique(scene.surface[lit])]
    photometric = photometric_with(both, emitting, scene.photometric if emitting or scene.photometric else None, scene.source)
    return replace(scene, lights=both, photometric=photometric)


def all_lights(scenes: list, n_bands: int, source: str) -> Lights:
    """Return the lights of several scenes, for a scene of so many bands."""
    lights = reduce(lambda one, other: merged(one, other, source), (scene.lights for scene in scenes))
    return in_bands(lights, n_bands)


def scaled(lights: Lights, factor: float) -> Lights:
    """Return lights of a file whose unit of length is another one: they move, and send what they sent."""
    moved = tuple(replace(one, position=one.position * factor, size=one.size * factor) for one in lights.luminaires)
    return replace(lights, luminaires=moved, openings=None if lights.openings is None else lights.openings * factor)


def in_bands(lights: Lights, n_bands: int) -> Lights:
    """Return lights with values for each band of a scene: those of one number are the same in all bands, and a grey scene takes
    the photopic mean of a colour.

    Raises:
        SceneError: a light has other bands.
    """
    luminaires = (replace(one, power=_wide(one, n_bands)) for one in lights.luminaires)
    suns = (replace(one, irradiance=_wide(one, n_bands)) for one in lights.suns)
    sky = None if lights.sky is None else replace(lights.sky, radiance=_wide(lights.sky, n_bands))
    return replace(lights, luminaires=tuple(luminaires), suns=tuple(suns), sky=sky)


def _values(light: Luminaire | Sun | Sky) -> np.ndarray:
    """Return what a light sends, (..., n_bands)."""
    key = {Luminaire: "power", Sun: "irradiance", Sky: "radiance"}[type(light)]
    return np.atleast_1d(np.asarray(getattr(light, key), np.float64))


def _wide(light: Luminaire | Sun | Sky, n_bands: int) -> np.ndarray:
    values = _values(light)
    found = values.shape[-1]
    if found == 1:
        return np.repeat(values, n_bands, axis=-1)
    if found == 3 and n_bands == 1:
        return (values @ PHOTOPIC)[..., None]
    if found != n_bands:
        raise SceneError(f"{_called(light)} has {found} bands, and the scene {n_bands}; give it one number, or {n_bands}")
    return values


def _in_color(scene: Any) -> Any:
    """Return a grey scene whose bands are red, green and blue, alike."""
    wide = {key: np.repeat(getattr(scene, key), 3, axis=1) for key in VALUES}
    paints = {key: paint and paint.in_bands(3) for key in PAINTS for paint in (getattr(scene, key),)}
    return replace(scene, **wide, **paints, bands=("red", "green", "blue"), lights=in_bands(scene.lights, 3))


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
