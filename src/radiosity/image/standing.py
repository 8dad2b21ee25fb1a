"""Cameras that stand on a face, whose lines of sight meet that face or pass it by rounding, and pictures that show nothing."""

import warnings

import numpy as np

from ..errors import RadiosityWarning, printable, result_kept
from ..scene import Camera, Scene
from ..scene.precision import OFFSET
from .projections import Panorama, View


def face_at(scene: Scene, point) -> int | None:
    """Return the first face that a point lies on, within what single precision holds apart; None where there is none.

    Args:
        point: (3,) metres.
    """
    origin, first, second = scene.frames
    point = np.asarray(point, np.float64)
    near = OFFSET * np.maximum(scene.plane_reach, np.abs(point - scene.centre).max())  # whatever lies far away
    away = point - origin
    u, v = _coordinates(away, first, second)
    slack_u, slack_v = (near / np.linalg.norm(edge, axis=1) for edge in (first, second))
    most = np.where(scene.is_quad, np.maximum(u - slack_u, v - slack_v), u + v - slack_u - slack_v)
    on = (np.abs((away * scene.normal).sum(axis=1)) <= near) & (u >= -slack_u) & (v >= -slack_v) & (most <= 1)
    return int(np.flatnonzero(on)[0]) if on.any() else None


def tell_of_standing(scene: Scene, view: View) -> bool:
    """Warn of a view from a point on a face; return whether it is one. An orthographic view has no such point."""
    if not isinstance(view, Camera | Panorama) or (face := face_at(scene, view.origin)) is None:
        return False
    place = ", ".join(f"{x:g}" for x in view.origin)
    surface = printable(scene.names[scene.surface[face]])
    _warn(
        f"{printable(scene.source)}: the camera at ({place}) stands in a face of '{surface}' (face {face}), so that its lines of "
        "sight meet that face or pass it by rounding; move it into the room, by a millimetre or more"
    )
    return True


def tell_of_nothing(scene: Scene, view: View, cover: np.ndarray) -> None:
    """Warn where a view stands on a face, or where no pixel of its picture shows anything that radiates.

    Args:
        cover: (height, width) share of each pixel that shows a patch.
    """
    if not tell_of_standing(scene, view) and not cover.any():
        _warn(
            f"{printable(scene.source)}: no line of sight meets a face from a side that radiates, so that the picture is empty; "
            f"move or turn the camera, which is {view}"
        )


def _coordinates(away: np.ndarray, first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates u and v, (n_faces,) each, of the foot of ``away`` in the frames of faces, (n_faces, 3) each."""
    aa, ab, bb = ((x * y).sum(axis=1) for x, y in ((first, first), (first, second), (second, second)))
    pa, pb = ((away * x).sum(axis=1) for x in (first, second))
    determinant = aa * bb - ab * ab
    return (pa * bb - pb * ab) / determinant, (pb * aa - pa * ab) / determinant


def _warn(text: str) -> None:
    with result_kept():
        warnings.warn(text, RadiosityWarning, stacklevel=4)
