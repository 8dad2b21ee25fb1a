"""Patches with other light: the same geometry and cut, with another emission or reflectance."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..scene.arguments import bands_of
from .model import Patches
from .values import values_of, widened


def relit(patches: Patches, emission=None, reflectance=None, bands=None) -> Patches:
    """Return the patches with another emission and reflectance; their scene has them too, as means over sides of faces.

    Args:
        emission, reflectance: None is what the patches have. Else one number; an array (1, n_bands); (n_patches,) or (n_patches,
            n_bands); (n_surfaces,) or (n_surfaces, n_bands) in the order of the scene's names; or a dictionary from names of
            surfaces (or patterns such as ``desk*``) to a number or one for each band, which leaves other surfaces as they are.
            In place of a number it may hold a dictionary of sides: ``{"front": 100, "back": 0}``. An emission without a side is
            that of the sides that emit already; where none does, of all that radiate.
        bands: names of the bands; default: those of the scene where there are as many, else those of `Scene.from_arrays`.

    Raises:
        SceneError: other shapes, or values out of range. MethodError: no such surface.
    """
    if emission is None and reflectance is None and bands is None:
        return patches
    given = {"emission": values_of(patches, emission, "emission"), "reflectance": values_of(patches, reflectance, "reflectance")}
    scene = patches.scene
    count = max(scene.n_bands if value is None else value.shape[1] for value in given.values())
    names = scene.bands if bands is None and count == scene.n_bands else bands_of(bands, count, scene.source)
    changed: dict[str, Any] = {"bands": names}
    kept = {}
    if scene.diffuse_transmittance is not None:
        changed["diffuse_transmittance"] = widened(scene.diffuse_transmittance, count, "diffuse_transmittance")
    for what, value in given.items():
        if value is None and scene.n_bands == count:
            kept[f"own_{what}"] = getattr(patches, f"own_{what}")
            continue
        values = widened(getattr(patches, what) if value is None else value, count, what)
        front, back = _of_faces(patches, values)
        changed |= {what: front, f"back_{what}": back, f"{what}_paint": None}
        cut = Patches(replace(scene, **{what: front, f"back_{what}": back, f"{what}_paint": None}), patches.columns, patches.rows)
        kept[f"own_{what}"] = None if np.array_equal(getattr(cut, what), values) else values
    return Patches(replace(scene, **changed), patches.columns, patches.rows, **kept)


def _of_faces(patches: Patches, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return means over the fronts and backs of faces, (n_faces, n_bands) each; a back without patches has that of the front.

    Where all patches of a side have the same value, the mean is that value to the bit.
    """
    n, sides = patches.scene.n_faces, 2 * patches.face.astype(np.int64) + patches.is_back
    count = np.bincount(sides, minlength=2 * n)
    first = np.searchsorted(sides, np.arange(2 * n))
    base = values[np.minimum(first, len(values) - 1)]
    more = np.stack([np.bincount(sides, band, 2 * n) for band in (values - base[sides]).T], axis=1)
    means = np.clip(base + more / np.maximum(count, 1)[:, None], values.min(axis=0), values.max(axis=0)).reshape(n, 2, -1)
    there = (count > 0).reshape(n, 2, 1)
    return means[:, 0], np.where(there[:, 1], means[:, 1], means[:, 0])
