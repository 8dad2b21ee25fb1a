"""Views that are no pinhole cameras: parallel lines of sight, for plans and elevations, and panoramas."""

from dataclasses import dataclass, replace

import numpy as np

from ..errors import OutputError, SceneError
from ..scene import Camera, Scene
from ..scene.up import up_axis
from . import view

MARGIN = 1.04  # of the scene's size: a plan shows some of what is around it


@dataclass(frozen=True)
class Orthographic:
    """A view along parallel lines; its plane cuts the scene, and what lies behind the plane is not seen.

    Attributes:
        origin: the middle of the view's plane, metres.
        target: a point straight ahead.
        up: its upward direction.
        size: metres from the lower to the upper edge of the picture.
        width, height: pixels.

    Example:
        >>> section = rd.Orthographic(origin=(2, 1.5, 1), target=(2, 1.5, 0), up=(0, 1, 0), size=3.0)
        >>> section.width, section.height
        (800, 600)
    """

    origin: tuple[float, float, float]
    target: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    size: float = 1.0
    width: int = 800
    height: int = 600


@dataclass(frozen=True)
class Panorama:
    """A view all around, equirectangular: columns are angles about ``up``, rows are heights, and the target is in the middle.

    Example:
        >>> around = rd.Panorama(origin=(1, 2, 1.6), target=(3, 2, 1.6))
        >>> around.width, around.height
        (1024, 512)
    """

    origin: tuple[float, float, float]
    target: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    width: int = 1024
    height: int = 512


View = Camera | Orthographic | Panorama


def plan(scene: Scene, *, cut: float | None = None, width: int | None = None, height: int | None = None) -> Orthographic:
    """Return the view from above on a whole scene.

    Args:
        cut: height of the plane that cuts it, metres; what is above is not seen. Default: above everything.
        width, height: pixels; default: 800 wide, and both fit the scene.

    Raises:
        OutputError: the cut is below the scene, or a size makes no sense.

    Example:
        >>> view = rd.plan(rd.load_scene("room"), cut=2.0, width=600)
        >>> view.width, view.height, view.target[2] < view.origin[2]
        (600, 400, True)
    """
    low, high = scene.bounds
    axis = "xyz".index(up_axis(scene))
    across, along = (0, 1) if axis == 2 else (0, 2)
    if cut is not None and not (np.isfinite(cut) and low[axis] < cut):
        raise OutputError(f"the plan's cut is at {cut} m; the scene begins at {low[axis]:g} m and ends at {high[axis]:g} m")
    for name, value in (("width", width), ("height", height)):
        if value is not None and not (np.isfinite(value) and int(value) == value >= 1):
            raise OutputError(f"{name} is {value}; it must be a whole number of 1 or more, in pixels")
    extent = np.maximum(high - low, 1e-6 * float((high - low).max())) * MARGIN
    aspect = extent[along] / extent[across]
    wide = width or (800 if height is None else max(round(height / aspect), 1))
    tall = height or max(round(wide * aspect), 1)
    middle = (low + high) / 2
    middle[axis] = high[axis] + 0.01 * extent.max() if cut is None else cut
    up = np.eye(3)[1] if axis == 2 else -np.eye(3)[2]  # north, or away from who looks at a scene that is y-up
    size = max(extent[along], extent[across] * tall / wide)
    origin, target = middle.tolist(), (middle - np.eye(3)[axis]).tolist()
    return Orthographic((*origin,), (*target,), (*up.tolist(),), float(size), wide, tall)


def checked(given: View) -> View:
    """Return the view, if it can take a picture.

    Raises:
        SceneError: its sizes, angles or directions make no picture.
    """
    view.check(_pinhole(given))
    if isinstance(given, Orthographic) and not (np.isfinite(given.size) and given.size > 0):
        raise SceneError(f"orthographic view: the size is {given.size} m; it must be a positive number")
    return given


def lines_of_sight(given: View, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return origins and unit directions of lines through picture points, (m, 3) each; x, y as of `view.directions`."""
    camera = _pinhole(given)
    if isinstance(given, Camera):
        rays = view.directions(camera, x, y)
        return np.broadcast_to(given.origin, rays.shape).copy(), rays
    right, up, forward = view.axes(camera)
    if isinstance(given, Orthographic):
        across, rise = (x - given.width / 2) / given.height, (given.height / 2 - y) / given.height
        origins = np.asarray(given.origin) + given.size * (across[:, None] * right + rise[:, None] * up)
        return origins, np.broadcast_to(forward, origins.shape).copy()
    vertical = np.asarray(given.up, np.float64) / np.linalg.norm(given.up)
    level = forward - vertical * (forward @ vertical)
    ahead = level / np.linalg.norm(level) if np.linalg.norm(level) > 1e-9 else np.cross(vertical, right)
    turn, rise = (x / given.width - 0.5) * 2 * np.pi, (0.5 - y / given.height) * np.pi
    beside = np.cross(ahead, vertical)
    rays = np.cos(rise)[:, None] * (np.cos(turn)[:, None] * ahead + np.sin(turn)[:, None] * beside)
    rays = rays + np.sin(rise)[:, None] * vertical
    return np.broadcast_to(given.origin, rays.shape).copy(), rays


def resized(given: View, width: int | None, height: int | None) -> View:
    """Return the view with another size; one alone keeps its proportions."""
    if width is None and height is not None:
        width = max(1, round(height * given.width / given.height))
    if height is None and width is not None:
        height = max(1, round(width * given.height / given.width))
    return replace(given, width=given.width if width is None else width, height=given.height if height is None else height)


def _pinhole(given: View) -> Camera:
    """Return a pinhole camera with the same place, direction and size."""
    if isinstance(given, Camera):
        return given
    return Camera(given.origin, given.target, given.up, width=given.width, height=given.height)
