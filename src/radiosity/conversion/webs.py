"""Lamps whose web of intensities a format can name: those that shine alike in all directions and spots of glTF and of Mitsuba."""

import numpy as np

from ..scene.lights.luminaire import Luminaire

FITS = 1e-3  # of the largest intensity, by which a spot may differ from its web


def uniform(lamp: Luminaire) -> bool:
    """Return whether a lamp is a point that shines alike in all directions."""
    web = lamp.web
    whole = web.gamma[0] == 0 and web.gamma[-1] == 180
    return whole and bool((web.intensity == web.intensity[0, 0]).all()) and not (lamp.soft and lamp.size.any())


def cone(lamp: Luminaire) -> tuple[float, float] | None:
    """Return the inner and outer angle, rad, of a spot that weakens between them as glTF says; None for another web.

    The intensity is the square of what is linear in the cosine of the angle between both.
    """
    web = lamp.web
    if len(web.planes) > 1 or web.gamma[0] != 0 or not 0 < web.gamma[-1] <= 90 or (lamp.soft and lamp.size.any()):
        return None
    cosine, root = np.cos(np.radians(web.gamma)), np.sqrt(web.intensity[0] / web.intensity[0].max())
    falls = root < 1 - 1e-9
    if root[-1] > FITS or not falls.any():
        return None
    low = cosine[-1]
    steep = (cosine[falls] - low) @ root[falls] / max(float((cosine[falls] - low) @ (cosine[falls] - low)), 1e-300)
    inner = float(np.arccos(np.clip(low + 1 / max(steep, 1e-12), -1, 1)))
    outer = float(np.radians(web.gamma[-1]))
    shape = np.clip((cosine - low) / max(np.cos(inner) - low, 1e-12), 0, 1) ** 2
    return (inner, outer) if inner < outer and np.abs(shape - root**2).max() < FITS else None


def linear_cone(lamp: Luminaire) -> tuple[float, float] | None:
    """Return the angles, degrees, up to which a spot is even, and at which it ends, if it weakens in proportion between them."""
    web = lamp.web
    if len(web.planes) > 1 or web.gamma[0] != 0 or not 0 < web.gamma[-1] < 180 or (lamp.soft and lamp.size.any()):
        return None
    share = web.intensity[0] / web.intensity[0].max()
    even = np.flatnonzero(share > 1 - 1e-9)
    beam, end = float(web.gamma[even[-1]]), float(web.gamma[-1])
    if beam == end:
        return (beam, end) if len(even) == len(share) else None
    line = np.clip((end - web.gamma) / (end - beam), 0, 1)
    return (beam, end) if np.abs(share - line).max() < FITS else None
