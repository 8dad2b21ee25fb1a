"""The first links: all pairs of whole sides that face each other, and whether there is room for them."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...device import memory
from ...errors import MethodError, RadiosityWarning
from ...patches import Hierarchy, elements
from ..estimate import LONG
from .kernel import PLANE
from .refine import MOST_LINKS

MOST_PAIRS = 1 << 33  # most pairs of sides: it takes minutes to find which face each other
BYTES = 128  # bytes of a link, while links are sorted
SECONDS = 2e-5  # rough time of a link with 16 rays, on two cores
BLOCK = 1 << 22  # pairs looked at together


@dataclass(frozen=True)
class Estimate:
    """The most that first links take: pairs of sides, bytes, and rough seconds. Refinement adds to it."""

    pairs: int
    bytes: int
    seconds: float

    def __str__(self) -> str:
        return f"{self.pairs:.3g} pairs of radiating sides, {self.bytes / 2**30:.2g} GiB and some {self.seconds:.2g} s"


def estimate(hierarchy: Hierarchy) -> Estimate:
    """Return the estimate before the run: it counts all pairs of two sides of different faces, as if all faced each other."""
    sides = len(hierarchy.side_face)
    return _of(sides * (sides - 1) - 2 * int(hierarchy.side_is_back.sum()))


def check(hierarchy: Hierarchy) -> None:
    """Refuse a hierarchy with too many pairs.

    Raises:
        MethodError: too many pairs of sides.
    """
    _refuse(estimate(hierarchy), MOST_PAIRS)


def root_pairs(hierarchy: Hierarchy, told: Callable[[int], None] = lambda rays: None) -> tuple[np.ndarray, np.ndarray]:
    """Return receivers and sources, root elements, that face each other; ``told(0)`` is called now and then, and may raise.

    Raises:
        MethodError: there are too many pairs.
    """
    check(hierarchy)
    roots = hierarchy.first[:-1]
    corners, normal = elements.corners(hierarchy, roots), elements.normal(hierarchy, roots)
    low, high = hierarchy.patches.scene.bounds
    height = np.einsum("si,si->s", corners[:, 0], normal) + PLANE * float((high - low).max())
    parts, found, size = [], 0, max(BLOCK // len(roots), 1)
    for at in range(0, len(roots), size):
        rows = np.arange(at, min(at + size, len(roots)))
        sees, seen = _in_front(normal[rows], height[rows], corners), _in_front(normal, height, corners[rows]).T
        receiver, source = np.nonzero(sees & seen & (hierarchy.side_face[rows][:, None] != hierarchy.side_face))
        found += len(receiver)
        told(0)
        _refuse(_of(found), MOST_LINKS)
        parts.append((roots[rows][receiver], roots[source]))
    receiver, source = (np.concatenate(column) for column in zip(*parts, strict=True))
    if _of(found).seconds > LONG:
        warnings.warn(
            f"hierarchical radiosity begins with {_of(found)}, and refinement adds to it; a larger epsilon takes less",
            RadiosityWarning,
            stacklevel=10,
        )
    return receiver, source


def _in_front(normal: np.ndarray, height: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return whether some corner of each of b polygons lies in front of each of a planes, (a, b) bool."""
    return (normal @ corners.reshape(-1, 3).T).reshape(len(normal), -1, 4).max(axis=2) > height[:, None]


def _of(pairs: int) -> Estimate:
    return Estimate(pairs, pairs * BYTES, pairs * SECONDS)


def _refuse(wanted: Estimate, most: int) -> None:
    room = memory.room()
    if wanted.pairs > most or (most == MOST_LINKS and wanted.bytes > room):
        raise MethodError(
            f"hierarchical radiosity begins with a link for all faces that see each other: {wanted} or more; {most:.3g} are the "
            f"most, in {memory.size(room)} of memory; merge small faces in the scene, or take a method that forms no matrix"
        )
