"""A choice of the faces of a scene, with all that belongs to them; and whether faces are parts of those of another scene."""

from dataclasses import replace
from typing import Any

import numpy as np

from .one_row import chosen
from .panes import panes_or_none

OF_FACES = ("faces", "reflectance", "emission", "back", "back_reflectance", "back_emission", "surface")
THROUGH = ("transmittance", "diffuse_transmittance", "refractive_index")  # None where no face has any
WITH_ROWS = ("reflectance_paint", "emission_paint", "cut")  # None, or what takes rows itself


def taken(scene, keep: np.ndarray):
    """Return the scene of a choice of faces (indices or mask)."""
    rows = np.flatnonzero(keep) if np.asarray(keep).dtype == bool else np.asarray(keep)
    changes: dict[str, Any] = {name: chosen(getattr(scene, name), rows) for name in OF_FACES}
    for name in THROUGH:
        values = getattr(scene, name)
        changes[name] = panes_or_none(None if values is None else chosen(values, rows))
    for name in WITH_ROWS:
        value = getattr(scene, name)
        changes[name] = value and value.take(rows)
    return replace(scene, **changes)


def is_cut_of(scene, whole, any_light: bool) -> bool:
    """Return whether the faces of a scene are parts of those of a whole one; see `Scene.is_cut_of`."""
    if scene.cut is None or scene.cut.whole != whole.hash:
        return False
    if any_light:
        return True
    paints = {
        name: getattr(scene, name)
        for name in ("reflectance_paint", "emission_paint")
        if getattr(scene, name) is not None and getattr(whole, name) is not None
    }
    return replace(taken(whole, scene.cut.face), vertices=scene.vertices, faces=scene.faces, **paints).hash == scene.hash
