"""The common refinement of two meshes: pieces of which each lies within one patch of either."""

from dataclasses import dataclass, replace

import numpy as np

from ..patches.model import Patches
from ..scene.split import split
from .clipping import parts
from .overlap import overlaps
from .whole_faces import SAME, WholeFaces


@dataclass(frozen=True, eq=False)
class Places:
    """Patches of which each lies within one patch of both solutions.

    Attributes:
        patches: those of both, or the pieces that the patches of one have in common with those of the other.
        first, second: (k,) int, the patch of each solution that each of these lies within.
        equal: the patches of both solutions are these.
    """

    patches: Patches
    first: np.ndarray
    second: np.ndarray
    equal: bool


def refined(one: Patches, two: Patches) -> Places | None:
    """Return the common refinement of two meshes; None where they are not of the same faces.

    Scenes that a mesh cut are held against each other by the places of their cells, since neither has the other's faces.
    """
    both = one, two
    if one.scene.cut is two.scene.cut is None and one.scene.geometry_hash != two.scene.geometry_hash:
        return None
    wholes = [WholeFaces.among(patches.scene) for patches in both]
    if not wholes[0].like(wholes[1]):
        return None
    planes, area = wholes[0].planes, wholes[0].area
    flat = [whole.cells(patches, planes) for whole, patches in zip(wholes, both, strict=True)]
    if any((height > SAME * np.sqrt(area[cells.face])).any() for cells, height in flat):
        return None
    common = overlaps(flat[0][0], flat[1][0], len(area))
    polygons, owner = parts(common.polygons)
    order = np.argsort(owner, kind="stable")
    polygons, owner = polygons[order], owner[order]
    fronts = [np.flatnonzero(~patches.is_back) for patches in both]
    within = [front[cell[owner]] for front, cell in zip(fronts, (common.first, common.second), strict=True)]
    face = one.face[within[0]]
    plain = replace(one.scene, reflectance_paint=None, emission_paint=None)
    pieces = split(plain, face, _in_faces(one, face, wholes[0].of[face], polygons, planes))
    if (np.abs(np.bincount(wholes[0].of[face], pieces.area, len(area)) - area) > SAME * area).any():
        return None
    ones = np.ones(pieces.n_faces, np.int32)
    result = Patches(pieces, ones, ones)
    back = result.is_back
    first, second = (
        at[result.face] + np.where(back, patches.cells_per_face[patches.face[at[result.face]]], 0)
        for at, patches in zip(within, both, strict=True)
    )
    return Places(result, first, second, False)


def _in_faces(patches: Patches, face: np.ndarray, whole: np.ndarray, polygons: np.ndarray, planes) -> np.ndarray:
    """Return polygons in the planes of whole faces, (m, k, 2), in coordinates of the faces that they lie in."""
    origin, axis, across = (vectors[whole] for vectors in planes)
    start, first, second = (frame[face] for frame in patches.scene.frames)
    flat = [np.stack([(vector * axis).sum(axis=1), (vector * across).sum(axis=1)], axis=1) for vector in (first, second)]
    corner = np.stack([((start - origin) * way).sum(axis=1) for way in (axis, across)], axis=1)
    offset = polygons - corner[:, None]
    (a, c), (b, d) = flat[0].T, flat[1].T
    determinant = (a * d - b * c)[:, None]
    x, y = offset[..., 0], offset[..., 1]
    u = (d[:, None] * x - b[:, None] * y) / determinant
    v = (a[:, None] * y - c[:, None] * x) / determinant
    return np.stack([u, v], axis=2)
