"""The eye of the page: where it stands at first, and the pictures that it saves."""

import tempfile
from pathlib import Path

import numpy as np

from ..image import bitmap
from ..image.false_color import beside
from ..image.picture import first_hits
from ..image.tone import luminance
from ..scene import Camera
from ..scene.up import up_axis
from . import frame as frames
from .frame import Frame
from .library import Client, Server
from .shades import Colours
from .subject import Subject

NEAR, FAR = 0.01, 20.0  # the page's units, and times the scene's size
WAIT = 60.0  # seconds for a picture of the page


def cameras(subject: Subject) -> dict[str, Camera]:
    """Return the views of a subject by name: the cameras of its scene, and one fitted to it."""
    from ..image.fit import fitted

    own = {f"camera {i}": camera for i, camera in enumerate(subject.patches.scene.cameras)}
    if own:
        return own
    light = np.ones(len(subject.patches)) if subject.solution is None else luminance(subject.solution.radiosity)
    return {"fitted": fitted(subject.patches, light, first_hits)}


def stand(server: Server, camera: Camera, subject: Subject, frame: Frame) -> None:
    """Let new pages begin with a camera's view, in black space."""
    server.scene.set_background_image(np.zeros((1, 1, 3), np.uint8), format="png")  # empty space is black, as in pictures
    server.scene.set_up_direction("+y" if up_axis(subject.patches.scene) == "y" else "+z")
    size = float(np.ptp(subject.patches.scene.bounds, axis=0).max()) * frame.scale
    eye = server.initial_camera
    eye.position, eye.look_at = frame.to_page(camera.origin), target(camera, size, frame)
    eye.up, eye.fov = np.asarray(camera.up, np.float64), float(np.deg2rad(camera.fov))
    eye.near, eye.far = NEAR, FAR * size


def target(camera: Camera, size: float, frame: Frame) -> np.ndarray:
    """Return the page's point that an eye turns around: on the camera's line of sight, half the scene's size away at most."""
    origin, seen = frame.to_page(camera.origin), frame.to_page(camera.target)
    away = seen - origin
    distance = float(np.linalg.norm(away))
    return origin + away / distance * np.clip(distance, 0.25 * size, 0.5 * size)


def move(client: Client, camera: Camera, subject: Subject, frame: Frame) -> None:
    """Give one page a camera's view."""
    size = float(np.ptp(subject.patches.scene.bounds, axis=0).max()) * frame.scale
    with client.atomic():
        client.camera.up_direction = np.asarray(camera.up, np.float64)
        client.camera.position = frame.to_page(camera.origin)
        client.camera.look_at = target(camera, size, frame)
        client.camera.fov = float(np.deg2rad(camera.fov))


def seen_by(client: Client, frame: Frame) -> Camera:
    """Return the camera that takes what a page shows."""
    eye = client.camera
    return frame.camera(eye.position, eye.look_at, eye.up_direction, eye.fov, eye.image_width, eye.image_height)


def picture(client: Client, frame: Frame, colours: Colours) -> bytes:
    """Return a PNG of what a page shows, with the legend of false colours, and its camera as text."""
    camera = seen_by(client, frame)
    drawn = client.get_render(camera.height, camera.width, transport_format="png", timeout=WAIT)
    pixels, legend = _on_black(drawn), colours.legend(max(240, camera.height))
    pixels = pixels if legend is None else beside(pixels, legend)
    facts = {
        "quantity": colours.quantity.title,
        "unit": colours.quantity.unit,
        "camera": repr(camera),
        "options": frames.options(camera),
    }
    with tempfile.TemporaryDirectory(prefix="radiosity-") as folder:
        path = Path(folder) / "view.png"
        bitmap.write_png(pixels, path, facts)
        return path.read_bytes()


def _on_black(drawn: np.ndarray) -> np.ndarray:
    """Return (height, width, 3) uint8: what is drawn, and black where nothing is."""
    if drawn.shape[2] == 3:
        return drawn
    opacity = drawn[..., 3:].astype(np.float64) / 255
    return np.rint(drawn[..., :3] * opacity).astype(np.uint8)
