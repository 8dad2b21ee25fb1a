"""Cameras: the points from which pictures are taken."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Camera:
    """A pinhole camera: ``origin``, ``target`` in metres, ``up``; ``fov`` is the vertical field of view, degrees.

    Example:
        >>> camera = rd.Camera(origin=(0, -3, 1.5), target=(0, 0, 1), fov=60)
        >>> camera.up, camera.width
        ((0.0, 0.0, 1.0), 800)
    """

    origin: tuple[float, float, float]
    target: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    fov: float = 40.0
    width: int = 800
    height: int = 600
