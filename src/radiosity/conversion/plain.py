"""Scenes without textures: means take the place of images and vertex colours."""

from dataclasses import replace

import numpy as np

from ..patches.model import Patches
from ..scene.model import Scene


def plain(scene: Scene, *, of_surfaces: bool) -> Scene:
    """Return a scene with means in place of textures and vertex colours.

    Args:
        of_surfaces: means over the painted faces of each surface; otherwise over each face.
    """
    if scene.reflectance_paint is None and scene.emission_paint is None:
        return scene
    one = np.ones(scene.n_faces, np.int32)
    patches = Patches(scene, one, one)
    fronts = patches.first[:-1]
    backs = np.where(np.diff(patches.first) > 1, fronts + 1, fronts)
    changes = {}
    for what in ("reflectance", "emission"):
        paint = getattr(scene, f"{what}_paint")
        if paint is None:
            continue
        for prefix, rows in (("", fronts), ("back_", backs)):
            values = getattr(patches, what)[rows].copy()
            if of_surfaces:
                _average(values, scene, paint.painted)
            changes[f"{prefix}{what}"] = values
    return replace(scene, reflectance_paint=None, emission_paint=None, **changes)


def _average(values: np.ndarray, scene: Scene, painted: np.ndarray) -> None:
    """Put the area mean over the painted faces of each surface in the place of their values, (n_faces, n_bands)."""
    surface, area, n = scene.surface[painted], scene.area[painted], len(scene.names)
    whole = np.bincount(surface, area, n)
    for band in range(values.shape[1]):
        total = np.bincount(surface, area * values[painted, band], n)
        values[painted, band] = (total / np.where(whole > 0, whole, 1))[surface]
