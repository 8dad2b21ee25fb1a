"""Panes of a .toml scene: what they let through, which must go with the reflectance, wherever that comes from."""

import numpy as np

from ....errors import SceneError
from ...assemble import DEFAULT_REFLECTANCE, Part
from ...clear_glass import mean_share, of_normal, share_at


def clear_light(entry, name: str, source: str) -> dict[str, float]:
    """Return the transmittance and the index of refraction of an entry, as `Material` has them.

    With an index, the entry's transmittance is that at right angles, as makers of glass give it. Else it holds for all angles.

    Raises:
        SceneError: no glass of this index lets so much through.
    """
    if entry.refractive_index is None:
        return {"transmittance": entry.transmittance, "refractive_index": 0.0}
    index, share = float(entry.refractive_index), float(entry.transmittance)
    most = float(share_at(np.ones(1), 1.0, index)[0])
    if not 0 < share <= most:
        raise SceneError(
            f"{source}: surface '{name}' has a transmittance of {share:g} and a refractive index of {index:g}: such glass lets "
            f"at most {most:.4f} through at right angles, and must let some"
        )
    return {"transmittance": float(mean_share(of_normal(share, index), index)), "refractive_index": index}


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
