"""Lattices: congruent patches beside each other in one plane, whose steps along an axis are all alike.

The cells of a face are such a lattice, and so are the faces of a wall that is made of equal parallelograms. The cells of a
triangle are two lattices, the upright and the inverted cells. Places on a lattice are whole numbers, by which neighbours are
found, so nothing is compared in pairs.
"""

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from ..patches.model import Patches
from ..scene.flat_pieces import numbered

FINE = 96  # steps of a cell in which places are told; a multiple of 3, for the centroids of triangles
BEFORE = 0.637  # of such a step: where the next one begins; no usual share of a cell, which would be rounded up or down by chance
ALIKE = 1 / 1021.3  # edges that agree to this, relative to their length, are alike; no round number, which edges have
DOMINANT = 0.437  # a component of a unit vector that tells its sign; no cosine of a usual angle
ALONG = (0.8231, 0.4417, 0.3571)  # a direction that tells the order of two edges
FACTORS = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x27D4EB2F165667C5], np.uint64)

Pairs = list[tuple[np.ndarray, np.ndarray]]
_known: "WeakKeyDictionary[Patches, Lattice]" = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Lattice:
    """The neighbours of patches along two axes, or three of triangles.

    Attributes:
        after: (3, n_patches) int64, the next patch along each axis, or -1.
        sheet: (n_patches,) int64, a number that patches of one kind, side and plane share.
    """

    after: np.ndarray
    sheet: np.ndarray

    @staticmethod
    def of(patches: Patches) -> "Lattice":
        """Return the lattice of patches. It is found once."""
        if patches not in _known:
            kind, axes, third = _kinds(patches)
            place = _places(patches, kind, axes)
            _known[patches] = Lattice(_neighbours(place, third[patches.face]), numbered(place[:, ::3].astype(np.float64)))
        return _known[patches]

    @cached_property
    def before(self) -> np.ndarray:
        """The patch before each one along each axis, or -1, (3, n_patches) int64."""
        result = np.full_like(self.after, -1)
        for back, forth in zip(result, self.after, strict=True):
            here = np.flatnonzero(forth >= 0)
            back[forth[here]] = here
        return result

    def pairs(self, count: int) -> list[Pairs]:
        """Return the pairs of patches at equal distances on both sides of each patch, for 1, 2, 4, ... steps, ``count`` of them.

        Where fewer patches are on one side, both distances are halved until both patches are there. A patch at a rim is its own
        pair along that axis. An axis that no patch has is left out.
        """
        itself = np.arange(self.after.shape[1])
        ways = [(back, forth) for back, forth in zip(self.before, self.after, strict=True) if (forth >= 0).any()]
        near: Pairs = [(itself, itself)] * len(ways)
        result = []
        for _ in range(count):
            for axis, (back, forth) in enumerate(ways):
                both = (back >= 0) & (forth >= 0)
                near[axis] = np.where(both, back, near[axis][0]), np.where(both, forth, near[axis][1])
            result.append(list(near))
            ways = [(_twice(back), _twice(forth)) for back, forth in ways]
        return result


def _twice(way: np.ndarray) -> np.ndarray:
    """Return the patch that two such ways after each other lead to, or -1."""
    return np.where(way >= 0, way[way], -1)


def _neighbours(place: np.ndarray, third: np.ndarray) -> np.ndarray:
    """Return `Lattice.after`.

    Args:
        place: see `_places`.
        third: (n_patches, 2) int64, the third axis in steps along the other two, or zeros.
    """
    key = (place.astype(np.uint64) * FACTORS).sum(axis=1, dtype=np.uint64)  # a hash: what it finds is compared below
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    again = ordered[1:] == ordered[:-1]
    alone = np.ones(len(key), bool)
    alone[order[1:][again]] = alone[order[:-1][again]] = False  # patches that lie on each other have no neighbours
    result = np.full((3, len(key)), -1)
    steps = np.zeros((3, len(key), 4), np.int64)
    steps[0, :, 1] = steps[1, :, 2] = FINE
    steps[2, :, 1:3] = FINE * third
    for after, step in zip(result, steps, strict=True):
        some = np.flatnonzero(alone & step.any(axis=1))
        to = place[some] + step[some]
        at = np.searchsorted(ordered, (to.astype(np.uint64) * FACTORS).sum(axis=1, dtype=np.uint64))
        found = order[np.minimum(at, len(order) - 1)]
        same = (place[found] == to).all(axis=1) & alone[found]
        after[some[same]] = found[same]
    return result


def _kinds(patches: Patches) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the kind of each face, the axes of its cells, and the third axis of triangles.

    Faces of one kind have one surface, look the same way, and their cells have the same edges, in any order. No contact line
    holds them apart.

    Returns:
        (n_faces,) int64; (n_faces, 3, 3), the scalar products with these are steps along two edges and the normal; (n_faces, 2)
        int64, the third edge in steps along the other two, zeros of a parallelogram.
    """
    scene = patches.scene
    _, first, second = scene.frames
    first, second = first / patches.columns[:, None], second / patches.rows[:, None]
    edges = np.stack([first, second, np.where(scene.is_quad[:, None], 0.0, second - first)], axis=1)
    length = np.linalg.norm(edges, axis=2)
    tells = (np.abs(edges) > DOMINANT * length[:, :, None]).argmax(axis=2)
    edges *= np.sign(np.take_along_axis(edges, tells[:, :, None], axis=2))
    rank = np.where(length > 0, edges @ np.array(ALONG), -np.inf)
    edges = np.take_along_axis(edges, np.argsort(-rank, axis=1, kind="stable")[:, :, None], axis=1)
    one, two, three = edges.transpose(1, 0, 2)
    size, upright = length.max(axis=1)[:, None], np.cross(one, two)
    _, power = np.frexp(size * 1.37)  # no round number, either
    facing = np.einsum("ij,ij->i", upright, scene.normal) > 0
    alike = np.rint(np.hstack([one, two]) / np.ldexp(ALIKE, power))
    region = np.zeros(scene.n_faces, np.int64) if scene.cut is None else scene.cut.region
    kind = numbered(np.column_stack([scene.surface, scene.is_quad, facing, power, alike, region]))
    area = np.linalg.norm(upright, axis=1, keepdims=True)
    normal = upright / np.where(area > 0, area, 1)
    axes = np.stack([np.cross(two, normal), np.cross(normal, one), normal * area / size], axis=1)
    axes /= np.where(area > 0, area, 1)[:, :, None]
    return kind, axes, np.rint(np.einsum("ijk,ik->ij", axes[:, :2], three)).astype(np.int64)


def _places(patches: Patches, kind: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Return the kind and side, and the place on its lattice of each patch, (n_patches, 4) int64."""
    begin = np.unique(kind, return_index=True)[1]
    origin, along = patches.centroid[patches.first[begin]], axes[begin]
    of = kind[patches.face]
    steps = np.einsum("ijk,ik->ij", along[of], patches.centroid - origin[of])
    place = np.clip(np.floor(steps * FINE + BEFORE), -(2.0**60), 2.0**60)
    return np.column_stack([2 * of + patches.is_back, place]).astype(np.int64)
