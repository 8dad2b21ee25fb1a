"""What Mitsuba's thin dielectric lets through: a pane of one transmittance, the mean over the directions of diffuse light."""

import numpy as np

from ....errors import SceneError, shown
from .node import Node

KNOWN = {
    "vacuum": 1.0,
    "air": 1.000277,
    "water ice": 1.31,
    "water": 1.333,
    "fused quartz": 1.458,
    "pyrex": 1.47,
    "acrylic glass": 1.49,
    "polypropylene": 1.49,
    "bk7": 1.5046,
    "sodium chloride": 1.544,
    "amber": 1.55,
    "pet": 1.575,
    "diamond": 2.419,
}  # indices of refraction by name, as in Mitsuba
STEPS = 1000  # cosines: the mean is right to 1e-6


def thin_pane(node: Node) -> float:
    """Return the share of diffuse light that goes through a clear pane, all reflections within it counted.

    A side reflects R of unpolarised light (Fresnel), so that the pane reflects 2 R / (1 + R), and the rest goes through.

    Raises:
        SceneError: an index of refraction that is not known, or not above 0.
    """
    ratio = _index(node, "int_ior", "bk7") / _index(node, "ext_ior", "air")
    cosine = (np.arange(STEPS) + 0.5) / STEPS
    square = 1 - (1 - cosine**2) / ratio**2
    inside = np.sqrt(np.maximum(square, 0))
    across = (cosine - ratio * inside) / (cosine + ratio * inside)
    along = (ratio * cosine - inside) / (ratio * cosine + inside)
    reflected = np.where(square > 0, (across**2 + along**2) / 2, 1.0)
    return float(np.mean((1 - 2 * reflected / (1 + reflected)) * 2 * cosine))


def _index(node: Node, key: str, default: str) -> float:
    given = node.values.get(key, default)
    if isinstance(given, str):
        if given.lower() not in KNOWN:
            raise SceneError(f"{node.place}: {key} is '{given}'; give a number, or one of {shown(KNOWN, 20)}")
        return KNOWN[given.lower()]
    if not isinstance(given, int | float) or not 0 < given < np.inf:
        raise SceneError(f"{node.place}: {key} is {given!r}; it must be a number above 0")
    return float(given)
