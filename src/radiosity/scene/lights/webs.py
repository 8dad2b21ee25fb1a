"""Webs in closed form: of lamps that shine alike in all directions, and of spots."""

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


def cone(inner: float, outer: float, shape) -> Web:
    """Return the web of a lamp of 1 cd up to ``inner`` degrees, nothing beyond ``outer``, and ``shape(rad)`` between them."""
    between = np.linspace(inner, outer, ENTRIES) if outer > inner else np.array([outer])
    values = np.clip(shape(np.radians(between)), 0, 1) if outer > inner else np.ones(1)
    gamma = between if inner <= 0 else np.append(0.0, between)
    return Web(np.zeros(1), gamma, (values if inner <= 0 else np.append(1.0, values))[None])
