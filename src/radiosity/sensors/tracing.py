"""The lines of sensors: a gather at each of them, which reads a solution."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import drjit as dr
import numpy as np

from ..algorithms.gather.beams import Beams
from ..algorithms.gather.chances import Chances
from ..algorithms.gather.lamps import Lamps
from ..algorithms.gather.lines import UNITS, Lines
from ..algorithms.gather.sums import Sums
from ..device.backend import upload
from ..method.presets import PRESETS
from ..problem.model import Problem
from ..sampling.blocks import BLOCK
from ..sampling.streams import Purpose, Seed
from ..tracing.geometry import Geometry
from .model import Sensors
from .receivers import Receivers
from .shares import PILOT, of_packets, pooled

OfLines = tuple[list, list, list]  # see `Tracing.sums`
DARK = 256.0  # units of a line in the mean: with fewer, rounding would be a part of what a sensor sees
FINEST, ROOM = 12, 35  # bits: of finer units, and of a line in the mean, so that sums of 2^24 lines and more fit in 64 bits


@dataclass(frozen=True, eq=False)
class Setup:
    """What lines of sensors follow from, besides the scene: see `Tracing.of`."""

    sensors: Sensors
    reflected: np.ndarray
    replicates: int
    seed: Seed
    direct: bool = True
    faces: np.ndarray | None = None
    finer: int = 1

    def tracing(self, geometry: Geometry, problem: Problem) -> "Tracing":
        """Return sums that have begun, without a pilot: for lines that somebody else shares out."""
        given = {"direct": self.direct, "faces": self.faces, "pilot": 0, "finer": self.finer}
        return Tracing.of(geometry, problem, self.sensors, self.reflected, self.replicates, self.seed, **given)


@dataclass(eq=False)
class Tracing:
    """Sums of the lines of sensors.

    Attributes:
        receivers: the lanes.
        lines: what traces them.
        read: what cosine lines read, of each group, or each of its coefficients.
        shares: (2, count) float64, lines of both kinds of each packet, one in the mean over planes and both kinds together.
        counts: (2, count) int64, lines so far.
        brought, met: sums.
        missed: lines that escaped and were lost.
        setup: what it was made of.
        elsewhere: traces lines in other places, and yields their sums in pieces; None: here.
    """

    receivers: Receivers
    lines: Lines
    read: list
    shares: np.ndarray
    counts: np.ndarray
    brought: Sums
    met: Sums
    missed: list
    setup: Setup
    traced: int = field(default=0)
    elsewhere: "Callable[[np.ndarray, np.ndarray], Iterator[OfLines]] | None" = None

    @staticmethod
    def of(
        geometry: Geometry,
        problem: Problem,
        sensors: Sensors,
        reflected: np.ndarray,
        replicates: int,
        seed: Seed,
        *,
        direct: bool = True,
        faces: np.ndarray | None = None,
        pilot: int = PILOT,
        finer: int = 1,
    ) -> "Tracing":
        """Run the pilot.

        Args:
            reflected: (replicates, n_patches, n_columns), see `sensors.reflected`.
            direct: the light of lamps, suns and the sky counts; False: only what surfaces reflect.
            faces: that sensors lie on, see `Receivers`.
            pilot: its lines of each kind of each plane, 2 or more; 0: without it, both kinds have half of the lines.
            finer: see `Lines`; a pilot finds it anew.
        """
        geometry.prepare()
        types, method = geometry.device.types, PRESETS["gather"].method
        one = Receivers(geometry, 1, sensors=sensors, seed=seed, faces=faces)
        chances = Chances(Lamps(geometry, problem), one, Beams.of(geometry, problem))
        variance = np.zeros((2, one.count))
        if pilot:
            trial = Lines.of(one, chances, problem, method, seed, (Purpose.SENSORS_PILOT, Purpose.SENSORS_PILOT_SHADOW))
            trial = trial if direct else _without_direct(trial)
            mean = [upload(types.Float, column.astype(np.float32)) for column in reflected.mean(axis=0).T]
            few, none = np.full(one.count, pilot), np.zeros(one.count, np.int64)
            cosine, _ = trial.cosine(none, few, read=mean, squares=True)
            shadow = trial.shadow(none, few if direct else none, squares=True)
            variance = pooled(np.stack([_variance(one, sums, pilot) for sums in (cosine, shadow)]), one.sizes, pilot)
            finer = _finer(np.stack([one.patch_values(np.array(total)) for total in cosine[: trial.groups]]) / pilot * trial.unit)
        shares = of_packets(variance, one.sizes, has_targets=direct and chances.targets > 0)
        receivers = one if replicates == 1 else Receivers(geometry, replicates, sensors=sensors, seed=seed, faces=faces)
        lines = Lines.of(receivers, chances, problem, method, seed, (Purpose.SENSORS, Purpose.SENSORS_SHADOW))
        lines = replace(lines if direct else _without_direct(lines), finer=finer)
        whole = np.broadcast_to(reflected, (replicates, *reflected.shape[1:]))
        read = [upload(types.Float, whole[..., column].astype(np.float32)) for column in range(whole.shape[2])]
        kinds: tuple[Any, ...] = (types.UInt64, types.Int64)
        brought, met = (Sums(receivers, kind, lines.groups) for kind in kinds)
        missed = [dr.zeros(types.UInt64, receivers.lanes) for _ in range(2)]
        traced = 2 * pilot * one.receivers
        counts, setup = np.zeros((2, one.count), np.int64), Setup(sensors, reflected, replicates, seed, direct, faces, finer)
        return Tracing(receivers, lines, read, shares, counts, brought, met, missed, setup, traced)

    def advance(self, each: float) -> None:
        """Trace until every plane has about ``each`` lines of both kinds together, in each replicate."""
        wanted = np.maximum(np.ceil(self.shares * each), (self.shares > 0) * 2).astype(np.int64)
        more = np.maximum(wanted - self.counts, 0)
        trace = self.elsewhere or (lambda before, more: iter([self.sums(before, more)]))
        for met, missed, brought in trace(self.counts, more):
            if met:
                self.met.add(_on_device(self.met.kind, met))
                kind = type(self.missed[0])
                self.missed = [total + kind(one) for total, one in zip(self.missed, _on_device(kind, missed), strict=True)]
            if brought:
                self.brought.add(_on_device(self.brought.kind, brought))
        dr.eval(self.met.low, self.brought.low, self.missed)
        self.counts = self.counts + more
        if int(self.counts.max()) >= BLOCK:
            self.met.set_apart()
            self.brought.set_apart()
        self.traced += int((more * self.receivers.sizes).sum()) * self.receivers.replicates

    def sums(self, before: np.ndarray, more: np.ndarray) -> OfLines:
        """Trace lines of each packet, and return what they met, how many were missed, and what shadow rays brought.

        All are whole numbers of each lane; a list is empty where no line was traced.

        Args:
            before, more: (2, count) int64, cosine lines and shadow rays of each packet so far, and now.
        """
        met, missed = self.lines.cosine(before[0], more[0], read=self.read) if more[0].any() else ([], [])
        brought = self.lines.shadow(before[1], more[1]) if more[1].any() else []
        return met, missed, brought

    def values(self) -> np.ndarray:
        """Return the irradiance of each sensor in each replicate, (replicates, n_sensors, n_groups), in shares of the unit."""
        cosine, rays = (np.maximum(self._of_planes(count), 1) for count in self.counts)
        found = []
        for brought, met in zip(self.brought.about(), self.met.about(), strict=True):
            here = self._planes(brought) / (rays * UNITS) + self._planes(met) / (cosine * self.lines.unit)
            found.append(self._sensors(here))
        return np.stack(found, axis=-1)

    def behind(self) -> np.ndarray:
        """Return the share of each sensor's cosine lines that met absorbing backs, (n_sensors,)."""
        lost = self._planes(self.missed[1]) / np.maximum(self._of_planes(self.counts[0]), 1)
        return self._sensors(lost).mean(axis=0)

    def _of_planes(self, counts: np.ndarray) -> np.ndarray:
        """Return numbers of packets for each plane, (receivers,) float64."""
        return np.repeat(counts, self.receivers.sizes)[self.receivers.place].astype(np.float64)

    def _planes(self, lanes) -> np.ndarray:
        return self.receivers.patch_values(np.array(lanes)).astype(np.float64)

    def _sensors(self, planes: np.ndarray) -> np.ndarray:
        """Return means over the planes of each sensor, (replicates, n_sensors)."""
        starts = np.flatnonzero(np.diff(self.receivers.sensor, prepend=-1))
        return np.add.reduceat(planes, starts, axis=1) / np.diff(np.append(starts, planes.shape[1]))


def _on_device(kind: Any, columns: list) -> list:
    """Return columns of whole numbers as device arrays; those of other machines come as numpy arrays."""
    return [upload(kind, one) if isinstance(one, np.ndarray) else one for one in columns]


def _finer(units: np.ndarray) -> int:
    """Return how much finer units must be so that the light of the darkest sensor is not lost in their rounding.

    Args:
        units: what a line of each sensor finds in the mean of the pilot, in the usual units.
    """
    if units.min() >= DARK:
        return 1
    return 1 << int(np.clip(ROOM - np.log2(max(float(units.max()), 1.0)), 0, FINEST))


def _without_direct(lines: Lines) -> Lines:
    """Return lines that see no lamp and no sky."""
    nothing = [dr.zeros(lines.types.Float, dr.width(column)) for column in lines.targets.emission]
    return replace(lines, targets=replace(lines.targets, emission=nothing, sky=None))


def _variance(receivers: Receivers, sums: list, lines: int) -> np.ndarray:
    """Return the variance of a line of each packet, (count,), the largest of the groups, relative to the light that comes."""
    half, found = len(sums) // 2, []
    for total, square in zip(sums[:half], sums[half:], strict=True):
        mean, of_squares = (receivers.patch_values(np.array(one, np.float64))[0] / lines for one in (total, square))
        found.append(np.maximum(of_squares - mean**2, 0))
    return receivers.by_packet(np.max(found, axis=0)) / receivers.sizes
