"""Webs in closed form: of lamps that shine alike in all directions, and of spots."""

from collections.abc import Callable

import numpy as np

from ...errors import SceneError
from .web import Web

HALF, TENTH = 0.5, 0.1  # of the largest intensity: at the edges of the beam and of the field
LEAST = 1e-4  # of the largest intensity: a spot sends nothing where it would send less
ENTRIES = 181
STEEPEST = 40.0  # exponent of a spot: its field is then 3 % wider than its beam


def uniform() -> Web:
    """Return the web of a lamp that shines alike in all directions, 1 cd."""
    return Web(np.zeros(1), np.array([0.0, 180.0]), np.ones((1, 2)))


def spot(beam: float, field: float | None, what: str) -> Web:
    """Return the web of a spot of 1 cd along gamma = 0: 1/2^(x^p), where x is gamma over half the beam angle.

    Args:
        beam: degrees between the directions of half the largest intensity, the full angle.
        field: degrees between those of a tenth; None: p is 2, a Gaussian, whose field is 1.82 times as wide as its beam.
        what: names the lamp in messages.

    Raises:
        SceneError: the angles are none, or the field is not wider than the beam.
    """
    if not 0 < beam < 360:
        raise SceneError(f"{what}: beam is {beam} degrees; it must lie between 0 and 360, the full angle of half the intensity")
    p = 2.0
    if field is not None:
        least = beam * np.log2(1 / TENTH) ** (1 / STEEPEST)
        if not least <= field <= 720:
            text = f"{what}: field is {field} degrees, and beam {beam}; the field, of a tenth of the intensity, must be wider"
            raise SceneError(f"{text}, {least:.4g} degrees or more")
        p = float(np.log(np.log2(1 / TENTH)) / np.log(field / beam))
    end = min(beam / 2 * np.log2(1 / LEAST) ** (1 / p), 180.0)
    gamma = np.linspace(0, end, ENTRIES)
    return Web(np.zeros(1), gamma, HALF ** ((gamma / (beam / 2)) ** p)[None])


def cone(inner: float, outer: float, shape: Callable[[np.ndarray], np.ndarray], entries: int = ENTRIES) -> Web:
    """Return the web of a cone: ``shape`` of the angle, rad, up to an angle, degrees, and nothing beyond it.

    Args:
        inner: the shape is constant up to here, degrees.
        outer: the end, degrees.
        shape: of angles, rad.
        entries: between the two angles; 2 where the shape is linear there.
    """
    gamma = np.linspace(inner, outer, entries) if outer > inner else np.array([outer])
    gamma = gamma if inner <= 0 else np.append(0.0, gamma)
    return Web(np.zeros(1), gamma, np.maximum(shape(np.radians(gamma)), 0.0)[None])
