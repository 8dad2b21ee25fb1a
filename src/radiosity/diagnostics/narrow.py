"""Faces that are too narrow for lines: lines begin a little inside the edges, which leaves much of a narrow face out."""

import warnings
from collections.abc import Sequence

import numpy as np

from ..errors import RadiosityWarning, shown
from ..patches.model import Patches
from ..scene.model import Scene
from ..tracing.geometry import Geometry

ASPECT = 100  # length of a narrow face over its width
TOLD = 0.01  # of the area of a surface or group: what it sends may be as far off, relative
LIGHT = "the light that they send may be as far off, which errors do not show; take wider faces, or a smaller scene"


def left_out(geometry: Geometry, labels: np.ndarray, n: int) -> np.ndarray:
    """Return the share of each group's area from which no line begins, (n,); 0 for a group without patches.

    Args:
        labels: (n_patches,) the group of each patch.
    """
    patches = geometry.patches
    missing = np.bincount(labels, geometry.left_out[patches.face] * patches.area, n)
    return missing / np.maximum(np.bincount(labels, patches.area, n), np.finfo(float).tiny)


def warn_of_light(geometry: Geometry, patches: Patches, *, stacklevel: int) -> None:
    """Warn, before a run by local lines, where the light is off.

    It is where lines leave out, of narrow faces, more than `TOLD` of the power of all lamps, or of the area that reflects, by
    reflectance. Of other faces, such as a small square far away, they leave out a rim all round, which matters little.

    Args:
        patches: those of the geometry, with light.
    """
    missing, names = np.where(_narrow(patches.scene), geometry.left_out, 0.0)[patches.face], patches.scene.names
    sent = [values.sum(axis=1) * patches.area for values in (patches.emission, patches.reflectance)]
    if any(missing @ each > TOLD * each.sum() for each in sent):
        warn_of_narrow(geometry, left_out(geometry, patches.surface, len(names)), names, LIGHT, stacklevel + 1)


def _narrow(scene: Scene) -> np.ndarray:
    """Return which faces are far longer than wide, (n_faces,) bool."""
    _, first, second = scene.frames
    longest = np.max([(edge**2).sum(axis=1) for edge in (first, second, second - first)], axis=0)
    return longest > ASPECT * scene.area


def warn_of_narrow(geometry: Geometry, share: np.ndarray, names: Sequence[str], harm: str, stacklevel: int) -> None:
    """Warn of groups whose share that is left out is above `TOLD`, and of the harm."""
    rows = np.flatnonzero(share > TOLD)
    if len(rows):
        told = shown([f"{names[i]}: {share[i]:.0%}" for i in rows[np.argsort(-share[rows])]])
        warnings.warn(
            f"{geometry.scene.source}: faces are so narrow, for the size of the scene, that lines leave out a part of their area "
            f"along the edges ({told}); {harm}",
            RadiosityWarning,
            stacklevel=stacklevel + 1,
        )
