"""The coordinates of the page: the scene's own, moved and scaled where single precision or the page's speeds would not do."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..image.mesh import FAR
from ..scene import Camera, Scene

SIZES = (0.5, 500.0)  # m: smaller and larger scenes are shown `USUAL` m large, since walking goes at 2 m a second
USUAL = 10.0


@dataclass(frozen=True, eq=False)
class Frame:
    """A point of the scene, (3,) m, which is the page's origin, and how many of the page's units a metre is."""

    origin: np.ndarray
    scale: float

    @staticmethod
    def of(scene: Scene) -> "Frame":
        """Return the frame of a scene: its own coordinates in metres, where these will do."""
        low, high = scene.bounds
        size = float((high - low).max())
        far = np.abs([low, high]).max() > FAR * size
        return Frame(scene.centre if far else np.zeros(3), 1.0 if SIZES[0] <= size <= SIZES[1] else USUAL / size)

    def to_page(self, points: ArrayLike) -> np.ndarray:
        """Return points of the page, (..., 3) float64, from those of the scene."""
        return (np.asarray(points, np.float64) - self.origin) * self.scale

    def to_scene(self, points: ArrayLike) -> np.ndarray:
        """Return points of the scene, (..., 3) float64 m, from those of the page."""
        return np.asarray(points, np.float64) / self.scale + self.origin

    def camera(self, position, look_at, up, fov: float, width: int, height: int) -> Camera:
        """Return the camera of a page; positions are the page's, ``fov`` is vertical, in radians."""
        (a, b, c), (d, e, f) = (self.to_scene(point).tolist() for point in (position, look_at))
        (x, y, z) = (float(value) for value in up)
        return Camera((a, b, c), (d, e, f), (x, y, z), float(np.rad2deg(fov)), int(width), int(height))


def options(camera: Camera) -> str:
    """Return the options of `radiosity render` that take the same view."""
    places = ((name, getattr(camera, name)) for name in ("origin", "target", "up"))
    texts = [f"--{name} {','.join(format(value + 0.0, '.7g') for value in place)}" for name, place in places]
    return " ".join([*texts, f"--fov {camera.fov:.6g}", f"--width {camera.width}", f"--height {camera.height}"])
