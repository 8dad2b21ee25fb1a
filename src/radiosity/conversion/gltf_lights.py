"""Lights without area as KHR_lights_punctual: points and spots in cd, suns in lux."""

import numpy as np

from ..scene.lights.model import Lights
from . import webs
from .told import Told

PUNCTUAL = "KHR_lights_punctual"


def lights_of(lights: Lights, told: Told) -> tuple[list[dict], list[dict]]:
    """Return the lights, and a node for each."""
    found, nodes = [], []
    for lamp in lights.luminaires:
        angles = None if webs.uniform(lamp) else webs.cone(lamp)
        if angles is None and not webs.uniform(lamp):
            told.add("luminaires whose webs are no points or spots of glTF are left out", [lamp.name])
            continue
        intensity = lamp.power / lamp.web.flux * lamp.web.intensity.max()
        kind: dict = {"type": "point"} if angles is None else {"type": "spot"}
        if angles is not None:
            kind["spot"] = {"innerConeAngle": angles[0], "outerConeAngle": angles[1]}
        found.append({"name": lamp.name, **kind, **_colour(intensity)})
        nodes.append(_node(lamp.name, len(found) - 1, lamp.axes[2], lamp.position))
        if lamp.group:
            told.add("groups of luminaires are left out", [lamp.group])
    for sun in lights.suns:
        if sun.diameter:
            told.add("suns lose their disc, so that their shadows are sharp", [sun.name])
        found.append({"name": sun.name, "type": "directional", **_colour(sun.irradiance)})
        nodes.append(_node(sun.name, len(found) - 1, -sun.direction, np.zeros(3)))
    if lights.sky is not None:
        told.add("skies are left out", [lights.sky.name])
    if lights and not all(light.photometric for light in lights.all):
        told.add("lights in W read back as lights in lm", [light.name for light in lights.all if not light.photometric])
    return found, nodes


def turn(forward: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Return the rotation, (3, 3), that makes -z look forward and y as far up as it can."""
    back = -np.asarray(forward, np.float64) / np.linalg.norm(forward)
    right = np.cross(up, back)
    if np.linalg.norm(right) <= 1e-9 * np.linalg.norm(up):
        right = np.cross(np.eye(3)[np.argmin(np.abs(back))], back)
    right /= np.linalg.norm(right)
    return np.column_stack([right, np.cross(back, right), back])


def matrix(rotation: np.ndarray, position: np.ndarray) -> list[float]:
    """Return a node's matrix, by columns."""
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = rotation, position
    return whole.T.ravel().tolist()


def _node(name: str, index: int, forward: np.ndarray, position: np.ndarray) -> dict:
    place = matrix(turn(forward, np.array([0.0, 0.0, 1.0])), position)
    return {"name": name, "matrix": place, "extensions": {PUNCTUAL: {"light": index}}}


def _colour(values: np.ndarray) -> dict:
    most = float(values.max())
    colour = {} if (values == values[0]).all() else {"color": (values / most).tolist()}
    return {"intensity": most, **colour}
