"""How likely a shadow ray from a receiver goes to each lamp, and to each light without area.

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
from ...tracing.geometry import Geometry
from .beams import Beams
from .boxes import Boxes
from .lamps import Lamps
from .packets import Packets

CLUSTER = 256  # lanes
SMALLER = (16, 64)  # lanes, where there are lights without area: their light changes within a few metres
ENTRIES = 1 << 22  # of the table of probabilities: clusters times groups
BY_POWER = 0.1  # share of the probability that goes by power alone
PIECE = 1 << 20  # entries that are computed at a time


@dataclass(frozen=True, eq=False)
class Chances:
    """The probabilities of clusters to choose targets: lamps come first, then lights without area.

    Attributes:
        lamps: the lamps of the scene.
        packets: the lanes; those of one replicate are clustered.
        beams: lights without area, where there are any.
    """

    lamps: Lamps
    packets: Packets
    beams: Beams | None = None

    @staticmethod
    def of(geometry: Geometry, problem: Problem) -> "Chances":
        """Return those of a scene; they are made once."""
        if "chances" not in geometry.made:
            geometry.made["chances"] = Chances(Lamps(geometry, problem), Packets(geometry, 1), Beams.of(geometry, problem))
        return geometry.made["chances"]

    @cached_property
    def size(self) -> int:
        """The lanes of a cluster: fewer where there are lights without area, and the table is not too large."""
        if self.beams is None:
            return CLUSTER
        fitting = (size for size in SMALLER if -(-self.packets.width // size) * self.targets <= ENTRIES // 2)
        return next(fitting, CLUSTER)

    @cached_property
    def clusters(self) -> int:
        return -(-self.packets.width // self.size)

    @property
    def targets(self) -> int:
        """The number of lamps and lights."""
        return len(self.lamps) + (0 if self.beams is None else len(self.beams))

    @cached_property
    def power(self) -> np.ndarray:
        """The share of each target in the power of all, (n_targets,) float64."""
        if self.beams is None:
            return self.lamps.power
        return self._light / self._light.sum()

    @cached_property
    def _light(self) -> np.ndarray:
        """The power of each target over the unit of light, (n_targets,) float64, m²."""
        if self.beams is None:
            return self.lamps.light
        return np.append(self.lamps.light, self.beams.power.max(axis=1) / self.lamps.geometry.bvh.scale**2)

    @cached_property
    def area(self) -> np.ndarray:
        """The area of each target in the BVH's units, (n_targets,) float64; lights count as one of 1."""
        return self.lamps.area if self.beams is None else np.append(self.lamps.area, np.ones(len(self.beams)))

    @cached_property
    def boxes(self) -> Boxes:
        """The boxes around clusters."""
        return Boxes.of(self.packets, self.size)

    @cached_property
    def groups(self) -> np.ndarray:
        """The first target of each group, and the number of targets, (n_groups + 1,) int64."""
        each = max(-(-self.targets * self.clusters // ENTRIES), 1)
        return np.append(np.arange(0, self.targets, each), self.targets)

    @cached_property
    def group_of(self) -> np.ndarray:
        return np.repeat(np.arange(len(self.groups) - 1), np.diff(self.groups))

    @cached_property
    def within(self) -> np.ndarray:
        """The probability of each target once its group is chosen, (n_targets,) float64; zero where the group has no power."""
        whole = np.add.reduceat(self.power, self.groups[:-1])[self.group_of]
        return np.divide(self.power, whole, out=np.zeros_like(self.power), where=whole > 0)

    @cached_property
    def probability(self) -> np.ndarray:
        """The probability of each group for each cluster, (clusters, n_groups) float32; rows sum to one, or are zero."""
        found = np.empty((self.clusters, len(self.groups) - 1), np.float32)
        step = max(PIECE // max(self.targets, 1), 1)
        for at in range(0, self.clusters, step):
            rows = slice(at, at + step)
            weight = np.add.reduceat(self._weights(self.boxes.take(rows)), self.groups[:-1], axis=1)
            total = weight.sum(axis=1, keepdims=True)
            found[rows] = np.divide(weight, total, out=np.zeros_like(weight), where=total > 0)
        return found

    def _weights(self, boxes: Boxes) -> np.ndarray:
        """Return weights of all targets for some clusters, (k, n_targets) float64."""
        power = self.power
        if len(self.lamps):
            weight, behind = power[: len(self.lamps)] * boxes.unobstructed(self.lamps), boxes.behind(self.lamps)
        else:
            weight, behind = np.zeros((len(boxes.middle), 0)), np.zeros((len(boxes.middle), 0), bool)
        if self.beams is not None:
            of_lights = self.beams.weights(boxes)
            irradiance = of_lights * (np.pi / (self.lamps.geometry.bvh.scale**2 * self._light.sum()))  # as of lamps
            weight = np.concatenate([weight, irradiance], axis=1)
            behind = np.concatenate([behind, of_lights == 0], axis=1)
        whole = weight.sum(axis=1, keepdims=True)
        weight = (1 - BY_POWER) * np.divide(weight, whole, out=np.zeros_like(weight), where=whole > 0) + BY_POWER * power
        return np.where(behind, 0.0, weight)

    # ---- on the device ---------------------------------------------------------------------------------------------

    def prepare(self) -> None:
        """Make what kernels read."""
        self.lamps.prepare()
        if not self.targets:
            return
        if self.beams is not None:
            self.beams.prepare()
        _ = self.cumulative, self.density, self.chosen_within, self.spans, self.n_lamps

    @property
    def types(self):
        return self.packets.types

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
        """The group of each target, sums of `within` up to it in its group, and `within` over its area, (3 arrays)."""
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
    def n_lamps(self):
        """The number of lamps, UInt32: targets from there on are lights without area."""
        return dr.opaque(self.types.UInt32, len(self.lamps))

    @cached_property
    def spans(self):
        """The first target of each group, and their number, (n_groups + 1,) UInt32."""
        return upload(self.types.UInt32, self.groups.astype(np.uint32))

    def row(self, place):
        """Return where the probabilities of the lanes' clusters begin."""
        return (place // self.size) * dr.opaque(self.types.UInt32, len(self.groups) - 1)

    def choose(self, row, number):
        """Return a target and its density, the probability over its area, from a number in [0, 1); called in a kernel."""
        UInt32, Float = self.types.UInt32, self.types.Float
        many = len(self.groups) - 1
        if self.targets == 1:
            lamp = number * 0
            return UInt32(lamp), dr.gather(Float, self.density, row) * dr.gather(Float, self.chosen_within[2], UInt32(lamp))
        group = _search(self.cumulative, row, row * 0, row * 0 + (many - 1), many, number, UInt32, Float)
        share = dr.gather(Float, self.density, row + group)
        if many == self.targets:
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
