"""Lights that a caller or a file gives: of the right kinds, and with values that make sense."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from ...errors import SceneError
from .luminaire import Luminaire
from .model import Lights
from .openings import opening
from .sky import Sky
from .sun import Sun

MAKERS = {Luminaire: "read_luminaire or point_light", Sun: "sun", Sky: "cie_sky, uniform_sky, perez_sky or epw_sky"}
UNIT = 1e-6  # how far axes and directions may be from unit length


def given(luminaires: Any, suns: Any, sky: Any, openings: Any, source: str) -> Lights:
    """Return lights from the arguments of `Scene.with_lights`.

    Raises:
        SceneError: something of another kind, or with values that make no sense.
    """
    lamps, far = (_all(many, kind, source) for many, kind in ((luminaires, Luminaire), (suns, Sun)))
    if sky is not None and not isinstance(sky, Sky):
        raise SceneError(f"{source}: sky is a {type(sky).__name__}; make one with {MAKERS[Sky]}")
    polygons = None
    if openings is not None:
        if not isinstance(openings, Iterable):
            raise SceneError(f"{source}: openings are a {type(openings).__name__}; give a list of corners, (n, 4, 3) m")
        found = [opening(corners, f"{source}: opening {number}") for number, corners in enumerate(openings, 1)]
        polygons = np.concatenate(found) if found else None
    lights = Lights(lamps, far, sky, polygons)
    fault = fault_of(lights)
    if fault:
        raise SceneError(f"{source}: {fault}")
    return lights


def fault_of(lights: Lights) -> str:
    """Return what is wrong with the values of lights, or nothing."""
    for one in lights.luminaires:
        web, what = one.web, f"luminaire '{one.name}'"
        shape = (len(web.planes), len(web.gamma))
        for name, values, wanted, good in (
            ("position", one.position, (3,), _finite),
            ("axes", one.axes, (3, 3), lambda x: np.allclose(x @ x.T, np.eye(3), atol=UNIT)),
            ("power", one.power, (np.size(one.power),), lambda x: _positive(x) and x.any()),
            ("size", one.size, (3,), _positive),
            ("planes", web.planes, shape[:1], _rising),
            ("gamma", web.gamma, shape[1:], _rising),
            ("intensity", web.intensity, shape, lambda x: _positive(x) and x.any()),
        ):
            if _wrong(values, wanted, good):
                return f"{what}: its {name} cannot be: {_short(values)}"
    for one in lights.suns:
        for name, values, wanted, good in (
            ("direction", one.direction, (3,), lambda x: abs(np.linalg.norm(x) - 1) <= UNIT),
            ("irradiance", one.irradiance, (np.size(one.irradiance),), _positive),
        ):
            if _wrong(values, wanted, good):
                return f"sun '{one.name}': its {name} cannot be: {_short(values)}"
    sky = lights.sky
    if sky is not None:
        if np.ndim(sky.radiance) != 3 or len(sky.radiance) % 2 or _wrong(sky.radiance, np.shape(sky.radiance), _positive):
            return f"sky '{sky.name}': its radiances make no sense: {_short(sky.radiance)}"
        if _wrong(sky.axes, (3, 3), lambda x: np.allclose(x @ x.T, np.eye(3), atol=UNIT)):
            return f"sky '{sky.name}': its axes make no sense: {_short(sky.axes)}"
    polygons = lights.openings
    if polygons is not None and _wrong(polygons, (len(polygons), 4, 3), _flat):
        return f"openings of the shape {np.shape(polygons)} make no sense"
    return ""


def light_bands(light: Luminaire | Sun | Sky) -> int:
    """Return the number of bands of a light."""
    values = {Luminaire: "power", Sun: "irradiance", Sky: "radiance"}[type(light)]
    return np.shape(getattr(light, values))[-1]


def _all(many: Any, kind: type, source: str) -> tuple:
    name = kind.__name__.lower()
    if isinstance(many, (Luminaire, Sun, Sky, str)) or not isinstance(many, Iterable):
        raise SceneError(f"{source}: {name}s are a {type(many).__name__}; give a list of what {MAKERS[kind]} makes")
    found = tuple(many)
    for one in found:
        if not isinstance(one, kind):
            raise SceneError(f"{source}: one of the {name}s is a {type(one).__name__}; make it with {MAKERS[kind]}")
    return found


def _wrong(values: Any, shape: tuple, good) -> bool:
    array = np.asarray(values)
    return array.dtype.kind not in "fiu" or array.shape != shape or not array.size or not bool(_finite(array) and good(array))


def _finite(values: np.ndarray) -> bool:
    return bool(np.isfinite(values).all())


def _positive(values: np.ndarray) -> bool:
    return bool((values >= 0).all())


def _rising(values: np.ndarray) -> bool:
    return bool((values >= 0).all() and (values <= 360).all() and (np.diff(values) > 0).all())


def _flat(polygons: np.ndarray) -> bool:
    cross = np.cross(polygons[:, 1] - polygons[:, 0], polygons[:, 2] - polygons[:, 0])
    return bool((np.linalg.norm(cross, axis=1) > 0).all())


def _short(values: Any) -> str:
    return str(np.asarray(values).ravel()[:4].tolist())
