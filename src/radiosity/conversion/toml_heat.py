"""What an entry of a .toml says of patch size and heat, where a surface may become several."""

import numpy as np

from ..scene.heat import Heat
from ..scene.model import Back, Scene
from .pieces import Piece
from .told import Told


def of_surface(scene: Scene, parts: list[Piece], piece: Piece, told: Told) -> dict:
    """Return what the entry of a piece says of patch size and heat.

    Args:
        parts: all pieces; those of one surface share its heat flow.
    """
    entry: dict = {}
    heat, surface = scene.heat, piece.surface
    if np.isfinite(scene.patch_size[surface]):
        entry["patch_size"] = float(scene.patch_size[surface])
    if heat is None:
        return entry
    if np.isfinite(heat.temperature[surface]):
        entry["temperature"] = float(heat.temperature[surface])
    elif np.isfinite(heat.flux[surface]):
        flux = float(heat.flux[surface]) * _share(scene, parts, piece)
        entry |= {"adiabatic": True} if flux == 0 else {"flux": flux}
        if len([one for one in parts if one.surface == surface]) > 1:
            what = "surfaces of a heat flow become several, which share it by area and may differ in temperature"
            told.add(what, [scene.names[surface]])
    if heat.isothermal[surface]:
        entry["isothermal"] = True
    emissivity = _emissivity(scene, heat, piece)
    return entry if emissivity is None else entry | {"emissivity": emissivity}


def _share(scene: Scene, parts: list[Piece], piece: Piece) -> float:
    """The share of a surface's radiating area that a piece has."""
    areas = {id(one): _area(scene, one) for one in parts if one.surface == piece.surface}
    return areas[id(piece)] / sum(areas.values())


def _area(scene: Scene, piece: Piece) -> float:
    return float(scene.area[piece.rows].sum()) * (2 if piece.back == Back.RADIATES else 1)


def _emissivity(scene: Scene, heat: Heat, piece: Piece):
    """The emissivity of a piece: of a back or a front that became a surface, that of its side."""
    emissivity = heat.emissivity[piece.surface]
    if not isinstance(emissivity, dict) or piece.back == Back.RADIATES:
        return emissivity
    return emissivity.get("front" if piece.name == scene.names[piece.surface] else "back")
