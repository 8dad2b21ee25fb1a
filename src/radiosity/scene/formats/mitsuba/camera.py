"""Perspective sensors of a Mitsuba scene."""

import re

import numpy as np

from ....errors import SceneError
from ...model import Camera
from .node import Node

FILM = (36.0, 24.0)  # millimetres, of a focal length


def read_camera(node: Node) -> Camera | None:
    """The camera of a sensor, or None where it is not in perspective.

    Raises:
        SceneError: numbers that make no camera.
    """
    if node.plugin not in ("perspective", "thinlens"):
        return None
    films = node.of("Film")
    film = films[0] if films else node
    width, height = (int(film.number(key, default)) for key, default in (("width", 768), ("height", 576)))
    matrix = np.asarray(node.values.get("to_world", np.eye(4)), float)
    origin, forward, up = matrix[:3, 3], matrix[:3, 2], matrix[:3, 1]
    if not np.isfinite(matrix).all() or not np.linalg.norm(np.cross(forward, up)) > 0 or min(width, height) < 1:
        raise SceneError(f"{node.place}: the sensor has no direction, or a film of {width} x {height} pixels")
    fov = _vertical(node, width / height)
    if not 0 < fov < 180:
        raise SceneError(f"{node.place}: the field of view of the sensor is {fov:g} degrees; it must lie between 0 and 180")
    target = origin + forward / np.linalg.norm(forward)
    return Camera(_triple(origin), _triple(target), _triple(up / np.linalg.norm(up)), fov, width, height)


def _triple(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in vector)
    return x, y, z


def _vertical(node: Node, aspect: float) -> float:
    """Vertical field of view in degrees; Mitsuba gives that of ``fov_axis``, or a focal length of 35 mm film."""
    if "fov" not in node.values:
        text = str(node.values.get("focal_length", "50mm"))
        match = re.fullmatch(r"\s*([0-9.eE+-]+)\s*(mm)?\s*", text)
        try:
            focal = float(match[1]) if match else 0.0
        except ValueError:
            focal = 0.0
        if not focal > 0:
            raise SceneError(f"{node.place}: the focal length of the sensor is '{text}'; expected a length such as 50mm")
        half, axis = np.hypot(*FILM) / 2 / focal, "diagonal"
    else:
        half, axis = np.tan(np.radians(node.number("fov", 0.0)) / 2), str(node.values.get("fov_axis", "x"))
    if axis == "smaller":
        axis = "y" if aspect > 1 else "x"
    elif axis == "larger":
        axis = "x" if aspect > 1 else "y"
    half = {"x": half / aspect, "y": half, "diagonal": half / np.hypot(aspect, 1)}.get(axis, half / aspect)
    return float(np.degrees(2 * np.arctan(half)))
