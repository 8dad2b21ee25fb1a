"""Patches that a lamp lights from so near that only cosine lines find its light, and that few of them find.

Where a lamp is near, the kernel is above the limit of `lines`, and its light counts for the cosine lines that hit it. A patch
that sees it at grazing angles has few such hits, or none in any replicate. The spread of replicates then says nothing of this
light. But without obstacles its form factor F is known, and n lines find it with a variance of F / n at most.
"""

from dataclasses import dataclass

import numpy as np

from ...factors.polygons.exchange import exchange
from .chances import Chances
from .targets import KERNEL

ENOUGH = 10.0  # hits in all replicates together: from there on their spread is known well enough
R4 = (1 / 1.1673039782614187) ** np.arange(1, 5)  # the additive recurrence of the root of x^5 = x + 1
PIECE = 1 << 20  # pairs of clusters and lamps at a time
MOST = 256  # pairs of clusters and lamps whose patches are looked at: where there are more, those with the largest kernels
POINTS = 128  # pairs of points of a patch and a lamp, which tell how much of the light comes from afar
INEXACT = 0.1  # of it: how well they tell
PEAK = 8.0  # times the mean kernel: points say little where the largest is above that
STEP = 128  # pairs of clusters and lamps at a time, whose patches are looked at


@dataclass(frozen=True, eq=False)
class Near:
    """Light that only cosine lines find.

    Attributes:
        factor: (n_patches,) float64, the form factor of each patch to lamps near it, without obstacles.
        variance: (n_patches, n_groups) float64, of what one cosine line finds of their light, in squared shares of the largest
            emission, at most.
    """

    factor: np.ndarray
    variance: np.ndarray

    @staticmethod
    def of(chances: Chances) -> "Near":
        """Return that of a scene; it is made once."""
        made = chances.lamps.geometry.made
        if "near" not in made:
            made["near"] = Near.made(chances)
        return made["near"]

    @staticmethod
    def made(chances: Chances) -> "Near":
        """Look for clusters that have a lamp near them, and sum the form factors of their patches."""
        lamps, packets = chances.lamps, chances.packets
        groups, order, bvh = lamps.problem.groups, packets.order[: packets.n], lamps.geometry.bvh
        emission = lamps.emission
        corners = lamps.corners[:, [0, 1, 3, 2]]  # around: they are stored row by row
        turned = (np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0]) * lamps.facing).sum(axis=1) < 0
        corners = np.where(turned[:, None, None], corners[:, ::-1], corners)
        points, normals = (packets.patches.centroid - bvh.centre) * bvh.scale, packets.patches.normal
        reach = np.sqrt(packets.patches.area) * bvh.scale  # about how far a patch lies around its centroid
        near = Near(np.zeros(packets.n), np.zeros((packets.n, groups.n_groups)))
        cluster, lamp = pairs(chances)
        for at in range(0, len(cluster), STEP):
            row, which = np.nonzero(cluster[at : at + STEP, None] * chances.size + np.arange(chances.size) < packets.n)
            patch, other = order[cluster[at + row] * chances.size + which], lamp[at + row]
            limit = KERNEL * chances.probability[cluster[at + row], chances.group_of[other]]
            limit = limit * chances.within[other] / lamps.area[other]
            kernel = largest_kernel(points[patch], normals[patch], reach[patch], corners[other], lamps.facing[other])
            some = kernel > limit
            patch, other = patch[some], other[some]
            cells = (packets.patches.corners[patch] - bvh.centre) * bvh.scale
            factor = exchange(cells, corners[other]) / (packets.patches.area[patch] * bvh.scale**2)
            factor = np.maximum(factor - far_factor(cells, corners[other], limit[some], lamps.area[other]), 0)
            np.add.at(near.factor, patch, factor)
            np.add.at(near.variance, patch, factor[:, None] * emission[other] ** 2)
        return near

    def unseen(self, lines: np.ndarray) -> np.ndarray:
        """Return the variance of what lines of each patch find, (n_patches, n_groups); zero where they find the lamps often.

        Args:
            lines: (n_patches,) cosine lines of all replicates together.
        """
        few = self.factor * lines < ENOUGH
        return np.where(few[:, None], self.variance / np.maximum(lines, 1)[:, None], 0.0)


def pairs(chances: Chances) -> tuple[np.ndarray, np.ndarray]:
    """Return clusters and lamps, (m,) int64 each, between which a kernel may be above the limit: `MOST` at most."""
    lamps, boxes = chances.lamps, chances.boxes
    if not len(lamps):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    step = max(PIECE // max(len(lamps), 1), 1)
    found: tuple[np.ndarray, ...] = (np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0))
    for at in range(0, chances.clusters, step):
        rows = slice(at, at + step)
        density = chances.probability[rows][:, chances.group_of] * (chances.within / chances.area)
        limit = KERNEL * density[:, : len(lamps)]
        kernel = boxes.take(rows).largest_kernel(lamps)
        cluster, lamp = np.nonzero((kernel > limit) & (limit > 0))
        excess = kernel[cluster, lamp] / limit[cluster, lamp]
        found = tuple(np.concatenate(two) for two in zip(found, (cluster + at, lamp, excess), strict=True))
        largest = np.argsort(-found[2], kind="stable")[:MOST]
        found = tuple(column[largest] for column in found)
    return found[0], found[1]


def largest_kernel(
    points: np.ndarray, normals: np.ndarray, reach: np.ndarray, corners: np.ndarray, facing: np.ndarray
) -> np.ndarray:
    """Return about the largest cos cos' / (pi r^2) = h h' / (pi r^4) of pairs of patches and lamps, (m,) float64.

    Here h is the height of the lamp above the patch's plane, h' that of the patch above the lamp's, and r their distance.

    Args:
        points, normals, reach: (m, 3), (m, 3), (m,) of patches: centroids, and how far they lie around them.
        corners, facing: (m, 4, 3), (m, 3) of lamps.
    """
    centre = corners.mean(axis=1)
    size = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    here = np.einsum("mki,mi->mk", corners - points[:, None], normals).max(axis=1) + reach
    there = ((points - centre) * facing).sum(axis=1) + reach
    above = np.maximum(np.abs(((points - centre) * facing).sum(axis=1)) - reach, 0)  # the least height
    beside = np.maximum(np.linalg.norm(points - centre, axis=1) - size - reach, 0)
    square = np.maximum(above**2, beside**2)
    return np.maximum(here, 0) * np.maximum(there, 0) / (np.pi * np.maximum(square, 1e-18) ** 2)


def far_factor(one: np.ndarray, other: np.ndarray, limit: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Return about the form factors between polygons over pairs of points whose kernel is below a limit, (m,), and a tenth more.

    Their kernels are bounded, so a few points are enough; where the kernel has a peak they are not, and zero is returned. The
    rest of the exact form factor is the part from near.

    Args:
        one, other: (m, 4, 3) corners around each; a triangle repeats its last one.
        limit: (m,).
        area: (m,) of ``other``.
    """
    numbers = np.arange(1, POINTS + 1)[:, None] * R4 % 1.0
    (here, up), (there, down) = (_points(polygons, numbers[:, at : at + 2]) for polygons, at in ((one, 0), (other, 2)))
    way = there - here
    square = np.maximum((way**2).sum(axis=2), 1e-30)
    heights = np.maximum((way * up[:, None]).sum(axis=2), 0) * np.maximum(-(way * down[:, None]).sum(axis=2), 0)
    kernel = heights / (np.pi * square**2)
    found = kernel * (kernel <= limit[:, None])
    mean = found.mean(axis=1)
    even = found.max(axis=1) < PEAK * mean
    return np.where(even, (1 + INEXACT) * area * mean, 0.0)


def _points(polygons: np.ndarray, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return points on parallelograms and triangles, (m, k, 3), and their unit normals, (m, 3)."""
    first, second = polygons[:, 1] - polygons[:, 0], polygons[:, 3] - polygons[:, 0]
    triangle = (polygons[:, 2] == polygons[:, 3]).all(axis=1)
    s, t = numbers.T
    folded = triangle[:, None] & (s + t > 1)
    s, t = np.where(folded, 1 - s, s), np.where(folded, 1 - t, t)
    normal = np.cross(first, second)
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return polygons[:, :1] + first[:, None] * s[..., None] + second[:, None] * t[..., None], normal
