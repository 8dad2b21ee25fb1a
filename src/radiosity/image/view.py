"""Pinhole cameras: the rays of a picture, and the place where a point appears in it."""

import numpy as np

from ..errors import SceneError
from ..scene import Camera

MOST_PIXELS = 2**28


def check(camera: Camera) -> Camera:
    """Return the camera, if it can take a picture.

    Raises:
        SceneError: its sizes, angles or directions make no picture.
    """
    numbers = np.array([*camera.origin, *camera.target, *camera.up, camera.fov], np.float64)
    if numbers.shape != (10,) or not np.isfinite(numbers).all():
        raise SceneError(f"camera {camera}: origin, target and up must be three finite numbers each, and fov one")
    if not 0 < camera.fov < 180:
        raise SceneError(f"camera: the vertical field of view is {camera.fov}°; it must lie between 0 and 180")
    if not (int(camera.width) == camera.width >= 1 and int(camera.height) == camera.height >= 1):
        raise SceneError(
            f"camera: the picture is {camera.width} x {camera.height} pixels; both must be whole numbers of 1 or more"
        )
    if camera.width * camera.height > MOST_PIXELS:
        raise SceneError(f"camera: the picture is {camera.width} x {camera.height} pixels, more than {MOST_PIXELS}")
    if not np.linalg.norm(numbers[3:6] - numbers[:3]) > 0:
        raise SceneError(f"camera: origin and target are both {camera.origin}; move one of them")
    return camera


def axes(camera: Camera) -> np.ndarray:
    """Return unit vectors to the right, up and forward of the picture, as rows, (3, 3)."""
    forward = np.subtract(camera.target, camera.origin, dtype=np.float64)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera.up)
    if np.linalg.norm(right) <= 1e-9 * np.linalg.norm(camera.up):
        # looking along up, where any right will do
        right = np.cross(forward, np.eye(3)[np.argmin(np.abs(forward))])
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(right, forward), forward])


def directions(camera: Camera, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return unit directions through picture points, (m, 3); x goes right and y down, in pixels from the top left corner."""
    right, up, forward = axes(camera)
    half = np.tan(np.deg2rad(camera.fov) / 2)
    across = (2 * x - camera.width) / camera.height * half
    down = (2 * y - camera.height) / camera.height * half
    result = forward + across[:, None] * right - down[:, None] * up
    return result / np.linalg.norm(result, axis=1, keepdims=True)


def project(camera: Camera, points: np.ndarray) -> np.ndarray:
    """Return picture x, y (pixels from the top left corner) and depth along the view (metres), (m, 3), of points (m, 3)."""
    right, up, depth = axes(camera) @ (np.asarray(points, np.float64) - camera.origin).T
    half = np.tan(np.deg2rad(camera.fov) / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        x = camera.width / 2 + right / depth / half * camera.height / 2
        y = camera.height / 2 - up / depth / half * camera.height / 2
    return np.stack([x, y, depth], axis=1)
