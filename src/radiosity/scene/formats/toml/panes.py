"""Panes of a .toml scene: the transmittance that it gives must go with the reflectance, wherever that comes from."""

import numpy as np

from ....errors import SceneError
from ...assemble import DEFAULT_REFLECTANCE, Part


def check_pane(part: Part, source: str) -> None:
    """Refuse a pane that would give back more light than it gets.

    Raises:
        SceneError: its transmittance and a reflectance are 1 or more together.
    """
    material = part.material
    paint = [1.0 if a is None or not a.size else float(a.max()) for a in (part.color, part.texture)]
    given = material.reflectance or (DEFAULT_REFLECTANCE,)
    highest = float(np.max([*given, *(material.back_reflectance or given)])) * paint[0] * paint[1]
    diffuse = max(material.diffuse_transmittance or (0.0,))
    if diffuse and highest + material.transmittance + diffuse >= 1:
        whose = "without a material it is taken as" if material.reflectance is None else "its reflectance is"
        raise SceneError(
            f"{source}: surface '{part.name}' has a diffuse transmittance of {diffuse:g} and a clear one of "
            f"{material.transmittance:g}, and {whose} {highest:g}; the sum must be below 1: give its reflectance, too"
        )
    if highest + material.transmittance >= 1:
        whose = "without a material it is taken as" if material.reflectance is None else "its reflectance is"
        raise SceneError(
            f"{source}: surface '{part.name}' has a transmittance of {material.transmittance:g}, and {whose} {highest:g}; the "
            "sum must be below 1: give its reflectance, too"
        )
