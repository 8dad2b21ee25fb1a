"""Sides of lamps that shine on a face from so near that its patches cannot hold their light.

Such a side lights the part of the face that it covers, and nothing else. A patch that it covers in part receives that light,
and gives it back from its open part: the scene becomes too bright, by far more than the stated errors. Meshes that are cut along
the lamp's outline hold the light.
"""

from dataclasses import dataclass

import numpy as np

from ..errors import shown
from ..patches import Patches
from ..scene.habits import warn
from .faces_near_lamps import emitting_sides, faced, open_share, points_of

POINTS = 512  # of emitting sides, by power
LEAST = 0.005  # of all light of surfaces: less is not told


@dataclass(frozen=True, eq=False)
class NearLamps:
    """Lamps that shine on a face from near.

    Attributes:
        names: "LAMP at SURFACE", those with most light first.
        distance, size: m, the smallest distance, and the largest patch.
        share: of the light of all surfaces that patches give back where they are not covered.
    """

    names: list[str]
    distance: float
    size: float
    share: float


def near_lamps(patches: Patches, device: str = "auto") -> NearLamps | None:
    """Return the lamps whose light patches that are covered in part give back; None where that is little of all light."""
    scene = patches.scene
    side = emitting_sides(patches, POINTS)
    if side is None:
        return None
    face, back = side % scene.n_faces, side >= scene.n_faces
    points = points_of(scene, face)
    found = faced(patches, points, scene.normal[face] * np.where(back, -1.0, 1.0)[:, None])
    if found is None:
        return None
    row, onto, height, uv, size = found
    reflectance = np.where((height > 0)[:, None], scene.reflectance[onto], scene.back_reflectance[onto]).mean(axis=1)
    if reflectance.sum() < LEAST * len(points):
        return None
    share = reflectance * open_share(patches, onto, height, uv, device) / len(points)
    if share.sum() < LEAST:
        return None
    names: dict[str, float] = {}
    for k in np.flatnonzero(share > 0):
        name = f"{scene.names[scene.surface[face[row[k]]]]} at {scene.names[scene.surface[onto[k]]]}"
        names[name] = names.get(name, 0.0) + float(share[k])
    rows = share > 0
    worst = sorted(names, key=lambda name: -names[name])
    return NearLamps(worst, float(np.abs(height[rows]).min()), float(size[rows].max()), float(share.sum()))


def told(found: NearLamps) -> str:
    """Return what to say of them."""
    return (
        f"{shown(found.names, 5)}: lamps shine on a face near them ({found.distance:.3g} m), whose patches are large "
        f"({found.size:.3g} m); those that a lamp covers in part give back some {found.share:.1%} of all light where they "
        "are not covered: the scene becomes too bright, which no error shows; take --contacts or --adaptive, which cut the face "
        "along such lamps, or smaller patches, or let the lamps emit on one side only"
    )


def warn_of_near_lamps(patches: Patches, device: str = "auto") -> None:
    """Warn where patches spread light that a lamp beside them should hold."""
    found = near_lamps(patches, device)
    if found is not None:
        warn(told(found))
