"""The rays by which cameras and sensors see patches, for `solve(importance=...)`."""

import numpy as np

from ..errors import MethodError
from ..image.standing import tell_of_standing
from ..image.view import check, directions
from ..scene.model import Camera, Scene
from .model import Sensors

RAYS = 1 << 16  # in all, at least
EACH = 16  # of a sensor, at least
IRRATIONAL = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)  # powers of 1 over the root of x^4 = x + 1
FORWARD = 1e-4  # m, in front of the plane of a sensor: so that one on a surface does not see the surface's back


def sight(scene: Scene, given) -> tuple[str, np.ndarray, np.ndarray]:
    """Return what sees, in words, and origins and unit directions of rays, (m, 3) each.

    Args:
        given: "camera" (the first) or "camera:1" (the second) of the scene, "sensors" of the scene's file, a `Camera`, or
            `Sensors`.

    Raises:
        MethodError: something else. SceneError: the scene has no such camera or sensors.
    """
    if isinstance(given, str):
        kind, _, number = given.partition(":")
        if kind == "camera" and (not number or number.isdigit()):
            return _of_camera(f"camera {number or 0}", _camera(scene, int(number or 0)), scene)
        if given == "sensors":
            return _of_sensors("the scene's sensors", Sensors.of_scene(scene))
    if isinstance(given, Camera):
        return _of_camera("a camera", given, scene)
    if isinstance(given, Sensors):
        return _of_sensors("sensors", given)
    shown = f"'{given}'" if isinstance(given, str) else type(given).__name__
    raise MethodError(
        f"importance is {shown}; give surface:NAME, camera, camera:1 (the scene's second), sensors (those of the scene's "
        "file), a Camera or Sensors"
    )


def _camera(scene: Scene, number: int) -> Camera:
    if number >= len(scene.cameras):
        there = len(scene.cameras)
        raise MethodError(f"{scene.source}: importance is for camera {number}; the scene has {there} (counted from 0)")
    return scene.cameras[number]


def _numbers(count: int) -> np.ndarray:
    """Return evenly spread points of the unit cube, (count, 3)."""
    return ((np.arange(count) + 0.5)[:, None] * IRRATIONAL) % 1.0


def _of_camera(called: str, camera: Camera, scene: Scene) -> tuple[str, np.ndarray, np.ndarray]:
    tell_of_standing(scene, check(camera))
    x, y, _ = _numbers(RAYS).T
    ways = directions(camera, x * camera.width, y * camera.height)
    return called, np.tile(np.asarray(camera.origin, np.float64), (RAYS, 1)), ways


def _of_sensors(called: str, sensors: Sensors) -> tuple[str, np.ndarray, np.ndarray]:
    each = max(-(-RAYS // len(sensors)), EACH)
    u, v, turn = np.tile(_numbers(each), (len(sensors), 1)).T
    normal, points = (np.repeat(x, each, axis=0) for x in (sensors.normals, sensors.points))
    first = np.cross(normal, np.where(np.abs(normal[:, :1]) < 0.5, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normal, first)
    upright = np.repeat(sensors.cylindrical, each)[:, None]  # the mean of the planes that contain the axis
    angle = 2 * np.pi * turn[:, None]
    plane = np.where(upright, np.cos(angle) * first + np.sin(angle) * second, normal)
    first, second = (np.where(upright, a, b) for a, b in ((normal, first), (np.cross(plane, normal), second)))
    angle, radius = 2 * np.pi * u[:, None], np.sqrt(v)[:, None]
    ways = radius * (np.cos(angle) * first + np.sin(angle) * second) + np.sqrt(1 - v)[:, None] * plane
    return called, points + FORWARD * plane, ways
