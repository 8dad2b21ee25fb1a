"""The correction of the radiosity that cosine lines read, along the stored lines."""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from ...patches.bases import Basis
from ...sampling.blocks import BITS, BLOCK
from .lane_scatter import LaneScatter
from .lines import UNITS
from .moments import units
from .packets import Packets
from .reading import Reading
from .rows import Rows
from .shares import Shares
from .stored_lines import StoredLines
from .sums import Sums

TOLERANCE = 3e-3  # of the mean irradiance, in the first correction; later ones take less, as errors do


@dataclass(frozen=True, eq=False)
class Correction:
    """The equation among patches along the stored lines of a gather.

    Attributes:
        packets: the lanes, and the packets of patches in them.
        shares: how many lines of each kind a packet has after N.
        stored: the lines that are stored, and where they hit.
        scatter: what becomes radiosity of what falls on each lane.
        basis: of the radiosity within a patch.
        groups: the number of groups of bands.
        unit: whole numbers for one unit of what a cosine line reads.
    """

    packets: Packets
    shares: Shares
    stored: StoredLines
    scatter: LaneScatter
    basis: Basis
    groups: int
    unit: float

    def of(self, done: int, brought: Sums, met: Sums, reading: Reading) -> tuple[Sums, Reading]:
        """Return sums of cosine lines, and what they read, corrected after N lines.

        Args:
            done: N, the lines of a replicate.
            brought: what shadow rays brought.
            met: what cosine lines read where they hit.
            reading: the radiosity that they read.
        """
        types = self.packets.types
        _, _, place, _ = self.packets.read()
        cosine, rays = (self._of_packets(each, place) for each in self.shares.counts(done))
        finer = units(self.basis) * self.groups
        irradiance = [
            types.Float(straight / (rays * (UNITS * unit)) + reflected / (cosine * (self.unit * unit)))
            for straight, reflected, unit in zip(brought.about(), met.about(), finer, strict=True)
        ]
        irradiance = [dr.select(cosine > 0, value, 0) for value in irradiance]
        dr.eval(irradiance)
        grown = max(done / self.shares.stored_quanta, 1.0)
        tolerance = TOLERANCE * np.max([self._mean(value) for value in irradiance[:: self.basis.size]], axis=0) / grown**0.5
        rows = self._rows(done, place)
        reading, means = reading.corrected(rows, irradiance, np.maximum(tolerance, 1e-12), first=grown == 1.0)
        met = met.copy()
        scales = (self.unit * unit for unit in finer)
        met.add([types.Int64(dr.round(types.Float64(mean) * cosine * scale)) for mean, scale in zip(means, scales, strict=True)])
        dr.eval(met.low)
        return met, reading

    def _rows(self, done: int, place) -> Rows:
        stored = self.packets.of_packets(self.shares.stored(done), place)
        dr.eval(stored)
        return Rows(self.packets, self.stored, stored, self.scatter)

    def _of_packets(self, counts: np.ndarray, place):
        """Return whole numbers of packets for each lane, Float64."""
        kind, low = self.packets.types.Float64, self.packets.of_packets(counts & (BLOCK - 1), place)
        if int(counts.max()) < BLOCK:
            return kind(low)
        return kind(low) + kind(self.packets.of_packets(counts >> BITS, place)) * float(BLOCK)

    def _mean(self, values) -> np.ndarray:
        """Return the mean of positive values of each replicate, (replicates,), from whole numbers, so that no order matters."""
        whole = self.packets.types.UInt64(dr.maximum(values, 0) * 2.0**24)
        return np.array(dr.block_sum(whole, self.packets.width), np.float64) / 2.0**24 / self.packets.width
