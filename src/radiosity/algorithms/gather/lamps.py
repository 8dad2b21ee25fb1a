"""Lamps: the sides of faces that emit, and how likely a shadow ray from a receiver goes to each.

Receivers are taken in clusters of neighbours. A cluster chooses a lamp with a probability in proportion to what the lamp would
send it without obstacles, bounded from the cluster's box, and to some extent by power alone. It is zero only for a lamp that is
behind the cluster's planes, or that the cluster is behind. Where lamps are many, neighbours form a group, which is chosen as
one; within it, lamps are chosen by power.
"""

from dataclasses import dataclass
from functools import cached_property

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...problem.model import Problem
from ...tracing.faces import COLUMN_BITS, QUAD
from ...tracing.geometry import Geometry
from .packets import Packets

CLUSTER = 256  # lanes
ENTRIES = 1 << 22  # of the table of probabilities: clusters times groups
BY_POWER = 0.1  # share of the probability that goes by power alone
GRAZING = 0.02  # least cosine that is counted
PIECE = 1 << 20  # entries that are computed at a time
NONE = 0xFFFFFFFF


@dataclass(frozen=True, eq=False)
class Lamps:
    """The lamps of a scene, and the probabilities of clusters to choose them."""

    geometry: Geometry
    problem: Problem
    packets: Packets

    @cached_property
    def sides(self) -> np.ndarray:
        """The lamps, (n_lamps, 2) int64: face, and 1 for its back. Neighbours follow each other."""
        patches = self.problem.patches
        lit = self.problem.groups.emission.any(axis=1)
        face, back = np.divmod(np.unique(2 * patches.face[lit].astype(np.int64) + patches.is_back[lit]), 2)
        centre = self.geometry.faces.corners[face].mean(axis=1)
        scaled = np.floor((centre - centre.min(axis=0)) / max(np.ptp(centre, axis=0).max(), 1e-300) * 1023)
        order = np.lexsort((*scaled.T, *np.floor(scaled / 64).T))
        return np.column_stack([face, back])[order]

    def __len__(self) -> int:
        return len(self.sides)

    @cached_property
    def first(self) -> np.ndarray:
        """The first patch of each lamp, (n_lamps,) int64."""
        patches, (face, back) = self.problem.patches, self.sides.T
        return patches.first[face] + back * patches.cells_per_face[face]

    @cached_property
    def cells(self) -> np.ndarray:
        """The number of patches of each lamp, (n_lamps,) int64."""
        return self.problem.patches.cells_per_face[self.sides[:, 0]]

    @cached_property
    def of_patch(self) -> np.ndarray:
        """The lamp of each patch, (n_patches + 2,) int64; -1 for patches of other faces, and for codes of lost lines."""
        found = np.full(len(self.problem.patches) + 2, -1)
        found[np.repeat(self.first - np.cumsum(self.cells) + self.cells, self.cells) + np.arange(self.cells.sum())] = np.repeat(
            np.arange(len(self)), self.cells
        )
        return found

    @cached_property
    def power(self) -> np.ndarray:
        """The share of each lamp in the power of all, its largest group of bands counted, (n_lamps,) float64."""
        patches, groups = self.problem.patches, self.problem.groups
        scaled = (groups.emission / np.maximum(groups.emission.max(axis=0), 1e-300)).max(axis=1) * patches.area
        power = np.bincount(self.of_patch[:-2][self.of_patch[:-2] >= 0], scaled[self.of_patch[:-2] >= 0], len(self))
        return power / power.sum()

    @cached_property
    def area(self) -> np.ndarray:
        """The area of each lamp in the BVH's units, (n_lamps,) float64."""
        return self.geometry.scene.area[self.sides[:, 0]] * self.geometry.bvh.scale**2

    # ---- probabilities ---------------------------------------------------------------------------------------------

    @cached_property
    def clusters(self) -> int:
        return -(-self.packets.width // CLUSTER)

    @cached_property
    def groups(self) -> np.ndarray:
        """Where each group of lamps begins, and the number of lamps, (n_groups + 1,) int64."""
        each = max(-(-len(self) * self.clusters // ENTRIES), 1)
        return np.append(np.arange(0, len(self), each), len(self))

    @cached_property
    def group_of(self) -> np.ndarray:
        return np.repeat(np.arange(len(self.groups) - 1), np.diff(self.groups))

    @cached_property
    def within(self) -> np.ndarray:
        """The probability of each lamp once its group is chosen, (n_lamps,) float64."""
        return self.power / np.add.reduceat(self.power, self.groups[:-1])[self.group_of]

    @cached_property
    def probability(self) -> np.ndarray:
        """The probability of each group for each cluster, (clusters, n_groups) float32; rows sum to one, or are zero."""
        found = np.empty((self.clusters, len(self.groups) - 1), np.float32)
        step = max(PIECE // max(len(self), 1), 1)
        boxes = self._boxes
        for at in range(0, self.clusters, step):
            rows = slice(at, at + step)
            weight = np.add.reduceat(self._weights(*(part[rows] for part in boxes)), self.groups[:-1], axis=1)
            total = weight.sum(axis=1, keepdims=True)
            found[rows] = np.divide(weight, total, out=np.zeros_like(weight), where=total > 0)
        return found

    @cached_property
    def _boxes(self):
        """Of each cluster: corners of the box of its patches, the mean normal, and how far normals lean from it (a cosine)."""
        patches, order = self.problem.patches, self.packets.order
        corners = self.geometry.faces.corners
        lows, highs = corners.min(axis=1)[patches.face[order]], corners.max(axis=1)[patches.face[order]]
        centre = (patches.centroid[order] - self.geometry.bvh.centre) * self.geometry.bvh.scale
        if not self.geometry.whole_faces:  # a cell lies near its centroid, and within its face
            reach = self._reach[order][:, None]
            lows, highs = np.maximum(lows, centre - reach), np.minimum(highs, centre + reach)
        starts = np.arange(self.clusters) * CLUSTER
        normal = np.add.reduceat(patches.normal[order], starts)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
        of_lane = np.repeat(normal, np.diff(np.append(starts, len(order))), axis=0)
        lean = np.minimum.reduceat((patches.normal[order] * of_lane).sum(axis=1), starts)
        return np.minimum.reduceat(lows, starts), np.maximum.reduceat(highs, starts), normal, np.clip(lean, -1, 1)

    @cached_property
    def _reach(self) -> np.ndarray:
        """How far the corners of each patch are from its centroid at most, (n,) float64, in the BVH's units."""
        patches = self.problem.patches
        _, first, second = self.geometry.faces.frames
        longest = np.linalg.norm(first, axis=1) / patches.columns + np.linalg.norm(second, axis=1) / patches.rows
        return longest[patches.face]

    def _weights(self, low, high, normal, lean) -> np.ndarray:
        """Return weights of all lamps for some clusters, (k, n_lamps) float64."""
        faces = self.geometry.faces
        face, back = self.sides.T
        corners, facing = faces.corners[face], faces.normals[face] * np.where(back, -1.0, 1.0)[:, None]
        middle, half = (low + high) / 2, (high - low) / 2
        radius = np.linalg.norm(half, axis=1)[:, None]
        centre = corners.mean(axis=1)
        size = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)[None]
        way = centre[None] - middle[:, None]
        square = (way**2).sum(axis=2)
        distance = np.sqrt(np.maximum(square, 1e-300))
        spread = np.minimum((radius + size) / distance, 1.0)  # sine of how far directions lean from the way between the middles
        turned = spread + np.sqrt(1 - lean**2)[:, None]
        here = np.where(lean[:, None] <= 0, 1.0, np.clip((way * normal[:, None]).sum(axis=2) / distance + turned, GRAZING, 1))
        there = np.clip(_facing(way, facing, distance) + spread, GRAZING, 1)
        near = square + 2 * (radius**2) / 3 + self.area[None] / np.pi
        weight = self.power * here * there / near
        total = weight.sum(axis=1, keepdims=True)
        weight = (1 - BY_POWER) * weight / total + BY_POWER * self.power
        return np.where(self._behind(middle, half, normal, lean, corners, facing), 0.0, weight)

    def _behind(self, middle, half, normal, lean, corners, facing) -> np.ndarray:
        """Return where no light can arrive: the cluster is behind the lamp, or the lamp behind all planes of the cluster."""
        slack = 1e-5 * (np.abs(corners).max() + np.abs(middle).max())
        reach = middle @ facing.T + half @ np.abs(facing).T  # the box's highest corner above the lamp's plane
        below = reach < (corners[:, 0] * facing).sum(axis=1)[None] - slack
        lowest = (middle * normal).sum(axis=1) - (half * np.abs(normal)).sum(axis=1)
        highest = np.einsum("kd,lcd->klc", normal, corners).max(axis=2)
        return below | ((lean > 1 - 1e-9)[:, None] & (highest < lowest[:, None] - slack))

    # ---- on the device ---------------------------------------------------------------------------------------------

    def prepare(self) -> None:
        """Make what kernels read."""
        _ = self.records, self.cumulative, self.density, self.lamp_of_patch, self.normals, self.chosen_within, self.spans

    @property
    def types(self):
        return self.geometry.device.types

    @cached_property
    def records(self):
        """Face (top bit: its back), cell counts and flags, first patch, and number of patches of lamps, (n_lamps * 4,) UInt32."""
        patches, (face, back) = self.problem.patches, self.sides.T
        counts = patches.columns[face] | patches.rows[face].astype(np.int64) << COLUMN_BITS
        counts |= np.where(patches.scene.is_quad[face], QUAD, 0)
        rows = np.column_stack([face | back << 31, counts, self.first, self.cells])
        return upload(self.types.UInt32, rows.astype(np.uint32))

    @cached_property
    def lamp_of_patch(self):
        """The lamp of each patch, (n_patches + 2,) UInt32, `NONE` for others."""
        return upload(self.types.UInt32, np.where(self.of_patch < 0, NONE, self.of_patch).astype(np.uint32))

    @cached_property
    def normals(self):
        """Unit normals of lamps, (n_lamps * 3,) Float."""
        face, back = self.sides.T
        normals = self.geometry.faces.normals[face] * np.where(back, -1.0, 1.0)[:, None]
        return upload(self.types.Float, normals.astype(np.float32))

    @cached_property
    def cumulative(self):
        """Sums of probabilities of the groups up to each, of each cluster, (clusters * n_groups,) Float."""
        return upload(self.types.Float, _cumulative(self.probability))

    @cached_property
    def density(self):
        """Probabilities of groups, (clusters * n_groups,) Float."""
        return upload(self.types.Float, self.probability)

    @cached_property
    def chosen_within(self):
        """Of each lamp: its group, sums of `within` up to it in its group, and `within` over its area, (3 arrays)."""
        sums = np.cumsum(self.within)
        sums -= np.concatenate([[0], sums])[self.groups[:-1]][self.group_of]
        sums[self.groups[1:] - 1] = 2.0
        types = self.types
        return (
            upload(types.UInt32, self.group_of.astype(np.uint32)),
            upload(types.Float, sums.astype(np.float32)),
            upload(types.Float, (self.within / self.area).astype(np.float32)),
        )

    @cached_property
    def spans(self):
        """Where each group begins, (n_groups + 1,) UInt32."""
        return upload(self.types.UInt32, self.groups.astype(np.uint32))

    def row(self, place):
        """Return where the probabilities of the lanes' clusters begin."""
        return (place // CLUSTER) * dr.opaque(self.types.UInt32, len(self.groups) - 1)

    def choose(self, row, number):
        """Return a lamp and its density, the probability over its area, from a number in [0, 1); called in a kernel."""
        UInt32, Float = self.types.UInt32, self.types.Float
        many = len(self.groups) - 1
        if len(self) == 1:
            lamp = number * 0
            return UInt32(lamp), dr.gather(Float, self.density, row) * dr.gather(Float, self.chosen_within[2], UInt32(lamp))
        group = _search(self.cumulative, row, row * 0, row * 0 + (many - 1), many, number, UInt32, Float)
        share = dr.gather(Float, self.density, row + group)
        if many == len(self):
            return group, share * dr.gather(Float, self.chosen_within[2], group)
        below = dr.gather(Float, self.cumulative, row + group - 1, group > 0)
        again = dr.clip((number - below) / dr.maximum(share, 1e-30), 0, 1 - 2.0**-24)
        first, last = (dr.gather(UInt32, self.spans, group + one) - one for one in (0, 1))
        lamp = _search(self.chosen_within[1], 0, first, last, int(np.diff(self.groups).max()), again, UInt32, Float)
        return lamp, share * dr.gather(Float, self.chosen_within[2], lamp)

    def density_of(self, row, lamp, active):
        """Return the density with which `choose` takes a point of a lamp; called in a kernel."""
        group = dr.gather(self.types.UInt32, self.chosen_within[0], lamp, active)
        share = dr.gather(self.types.Float, self.density, row + group, active)
        return share * dr.gather(self.types.Float, self.chosen_within[2], lamp, active)


def _facing(way: np.ndarray, facing: np.ndarray, distance: np.ndarray) -> np.ndarray:
    return -(way * facing[None]).sum(axis=2) / distance


def _cumulative(rows: np.ndarray) -> np.ndarray:
    """Return sums along rows, the last positive entry and those after it 2, so that a search always ends there."""
    sums = np.cumsum(rows, axis=1, dtype=np.float64)
    last = rows.shape[1] - 1 - np.argmax(rows[:, ::-1] > 0, axis=1)
    return np.where(np.arange(rows.shape[1]) >= last[:, None], 2.0, sums).astype(np.float32)


def _search(sums, row, low, high, most: int, number, UInt32, Float):
    """Return the first place from ``low`` to ``high`` whose sum is above a number; called in a kernel."""
    for _ in range(int(np.ceil(np.log2(max(most, 2))))):
        middle = (low + high) >> 1
        above = number >= dr.gather(Float, sums, row + middle)
        low, high = dr.select(above, middle + 1, low), dr.select(above, high, middle)
    return low
