"""Lattices: congruent patches beside each other in one plane, whose steps along an axis are all alike.

The cells of a face are such a lattice, and so are the faces of a wall that is made of equal parallelograms. The cells of a
triangle are two lattices, the upright and the inverted cells. Places on a lattice are whole numbers, by which neighbours are found,
so nothing is compared in pairs.
"""

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from ..patches.model import Patches
from ..scene.flat_pieces import numbered

FINE = 96  # steps of a cell in which places are told; a multiple of 3, for the centroids of triangles
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
            kind, basis, third = _kinds(patches)
            place = _places(patches, kind, basis)
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

    def pairs(self, levels: int) -> list[Pairs]:
        """Return the pairs of patches at equal distances on both sides of each patch, for 1, 2, 4, ... steps.

        Where fewer patches are on one side, both distances are halved until both patches are there. A patch at a rim is its own
        pair along that axis. An axis that no patch has is left out.
        """
        n = self.after.shape[1]
        itself = np.arange(n)
        ways = [(back, forth) for back, forth in zip(self.before, self.after, strict=True) if (forth >= 0).any()]
        near = [(itself, itself)] * len(ways)
        result = []
        for _ in range(levels):
            for axis, (back, forth) in enumerate(ways):
                both = (back >= 0) & (forth >= 0)
                near[axis] = tuple(np.where(both, far, old) for far, old in zip((back, forth), near[axis], strict=True))
            result.append(list(near))
            ways = [tuple(np.where(way >= 0, way[way], -1) for way in pair) for pair in ways]
        return result


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
    """Return the kind of each face, its axes, and what the third axis of a triangle is of them.

    Faces of one kind have one surface, look the same way, and their cells have the same edges, in any order.

    Returns:
        (n_faces,) int64; (n_faces, 3, 3) metres, two edges and a normal of like length; (n_faces, 2) int64, zeros of a
        parallelogram.
    """
    scene = patches.scene
    _, first, second = scene.frames
    first, second = first / patches.columns[:, None], second / patches.rows[:, None]
    edges = np.stack([first, second, np.where(scene.is_quad[:, None], 0.0, second - first)], axis=1)
    length = np.linalg.norm(edges, axis=2)
    tells = np.abs(edges) > DOMINANT * length[:, :, None]
    sign = np.sign(np.take_along_axis(edges, tells.argmax(axis=2)[:, :, None], axis=2))
    edges = edges * sign
    rank = np.where(length > 0, edges @ np.array(ALONG), -np.inf)
    edges = np.take_along_axis(edges, np.argsort(-rank, axis=1, kind="stable")[:, :, None], axis=1)
    size = np.linalg.norm(edges[:, :2], axis=2).max(axis=1)
    facing = np.einsum("ij,ij->i", np.cross(edges[:, 0], edges[:, 1]), scene.normal) > 0
    _, power = np.frexp(size * 1.37)
    rounded = np.rint(edges[:, :2].reshape(-1, 6) / np.ldexp(ALIKE, power)[:, None])
    key = np.column_stack([scene.surface, scene.is_quad, facing, power, rounded]) + 0.0
    kind = numbered(key)
    basis = np.stack([edges[:, 0], edges[:, 1], scene.normal * size[:, None]], axis=1)
    third = np.rint(np.einsum("ijk,ik->ij", np.linalg.inv(basis).transpose(0, 2, 1), edges[:, 2]))[:, :2].astype(np.int64)
    return kind, basis, third


def _places(patches: Patches, kind: np.ndarray, basis: np.ndarray) -> np.ndarray:
    """Return the kind and side, and the place on its lattice of each patch, (n_patches, 4) int64."""
    _, begin, kind = np.unique(kind, return_index=True, return_inverse=True)
    kind = kind.ravel()
    origin = patches.centroid[patches.first[begin]]
    turned = np.linalg.inv(basis[begin])
    of = kind[patches.face]
    place = np.einsum("ij,ijk->ik", patches.centroid - origin[of], turned[of])
    return np.column_stack([2 * of + patches.is_back, np.rint(place * FINE)]).astype(np.int64)
