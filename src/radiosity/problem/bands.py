"""Bands: which of them are one problem, and the powers that lines carry where they are not (contract 3)."""

import functools
from dataclasses import dataclass

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..patches.model import Patches
from .quanta import Source

QUANTUM = 2**31  # fixed point units of a quantum: an arrival adds at most one, and 2^32 of them fit in 64 bits


@dataclass(frozen=True, eq=False)
class BandGroups:
    """Bands whose reflectances are equal everywhere and whose emissions are proportional are solved once.

    Attributes:
        index: (n_bands,) int, the group of each band.
        scale: (n_bands,) float64: the band's emission over the group's.
        emission, reflectance: (n_patches, n_groups) float64, of each group.
    """

    index: np.ndarray
    scale: np.ndarray
    emission: np.ndarray
    reflectance: np.ndarray

    @staticmethod
    def of(patches: Patches) -> "BandGroups":
        """Compare the bands of a scene."""
        emission, reflectance = patches.emission, patches.reflectance
        n_bands = emission.shape[1]
        index, scale, leaders = np.zeros(n_bands, np.int64), np.zeros(n_bands), []
        for band in sorted(range(n_bands), key=lambda b: (not emission[:, b].any(), b)):
            if leaders and not emission[:, band].any():
                continue  # nothing in, nothing out: any group times zero
            for group, leader in enumerate(leaders):
                at = int(np.argmax(emission[:, leader]))
                ratio = emission[at, band] / emission[at, leader] if emission[at, leader] else 0.0
                if (
                    ratio
                    and np.array_equal(reflectance[:, band], reflectance[:, leader])
                    and np.allclose(emission[:, band], ratio * emission[:, leader], rtol=1e-14, atol=0)
                ):
                    index[band], scale[band] = group, ratio
                    break
            else:
                index[band], scale[band] = len(leaders), 1.0
                leaders.append(band)
        if leaders != list(range(n_bands)):  # else they are the patches' own arrays, which need no copy
            emission, reflectance = emission[:, leaders], reflectance[:, leaders]
        return BandGroups(index, scale, emission, reflectance)

    @property
    def n_groups(self) -> int:
        return self.emission.shape[1]


class BandTally:
    """Power of each group, in 64-bit fixed point, received by every patch and carried by its lines.

    A line carries, of each band, what its patch has not sent yet divided by the real number of lines owed for it, not by the
    number fired. What is left so in the end is known, and sent on as `residue` tells. The groups of a patch lie side by side
    in memory, so that a landing touches one place.

    Attributes:
        groups: the bands.
        received: UInt64, group g of slot s (see `firing`) at s * n_groups + g.
        sent: UInt64, what lines have carried away from patch numbers, likewise.
        arrivals_before: UInt32, of patch numbers, as they were at the last sweep; None between stages.
        fired: UInt64, power that left replicate r along lines, at g * replicates + r.
        weights: UInt32, of group g, what each line of the i-th patch of a sweep carries, at i * n_groups + g; None between
            stages.
    """

    def __init__(self, engine, groups: BandGroups):
        self.groups, self.n = groups, groups.n_groups
        types, areas = engine.types, engine.geometry.patches.area
        self.shares = [upload(types.Float64, groups.emission[:, g] * areas / engine.source.power) for g in range(self.n)]
        self.rhos = [upload(types.UInt32, Source.fixed(groups.reflectance[:, g])) for g in range(self.n)]
        self.received = dr.opaque(types.UInt64, 0, (engine.total + 2 * engine.replicates) * self.n)
        self.sent = dr.opaque(types.UInt64, 0, engine.total * self.n)
        self.fired = dr.opaque(types.UInt64, 0, self.n * engine.replicates)
        self.weights = self.arrivals_before = None

    def rest(self) -> None:
        """Between stages: let go of what only sweeps use."""
        self.weights = self.arrivals_before = None

    def weigh(self, engine, numbers, places, arrivals, counts) -> None:
        """Before a sweep: what each line of the patches ``numbers`` carries, of each group, to ``places`` in ``weights``; in the
        end what ``counts`` of them take away, and ``arrivals`` now. No expression may still wait to read the arrays that are
        written here, or Dr.Jit copies them whole."""
        types = engine.types
        if self.weights is None:
            self.weights = dr.opaque(types.UInt32, 0, engine.total * self.n)
            self.arrivals_before = dr.opaque(types.UInt32, 0, engine.total)
        self._weigh(engine, numbers, places, arrivals)
        dr.eval(self.weights)
        dr.scatter(self.arrivals_before, arrivals, numbers)
        for g in range(self.n):
            power = types.UInt64(dr.gather(types.UInt32, self.weights, places * self.n + g)) * types.UInt64(counts)
            dr.scatter_add(self.sent, power, numbers * self.n + g, mode=dr.ReduceMode.NoConflicts)
        dr.eval(self.arrivals_before, self.sent)

    def _weigh(self, engine, numbers, places, arrivals) -> None:
        types = engine.types
        wide = types.Float64

        def fraction(rho):
            return wide(dr.gather(types.UInt32, rho, patch)) * 2.0**-32

        patch = numbers - engine.replicate(numbers) * engine.n_opaque
        quanta, fired = dr.opaque(wide, float(engine.quanta)), dr.gather(types.UInt32, engine.fired, numbers)
        emitted = [dr.gather(wide, share, patch) for share in self.shares]
        target_counts = dr.fma(functools.reduce(dr.maximum, emitted), quanta, fraction(engine.rho) * wide(arrivals)) - wide(fired)
        for g, (share, rho) in enumerate(zip(emitted, self.rhos, strict=True)):
            received, sent = (dr.gather(types.UInt64, column, numbers * self.n + g) for column in (self.received, self.sent))
            power = dr.fma(share, quanta * QUANTUM, fraction(rho) * wide(received)) - wide(sent)
            carried = dr.select(target_counts > 0, dr.clip(power / target_counts, 0, QUANTUM), 0)
            dr.scatter(self.weights, types.UInt32(dr.floor(carried + 0.5)), places * self.n + g)

    def carried(self, types, chunk) -> list:
        """In a kernel: the power of each group that a line of each lane carries."""
        place = (chunk.rank + chunk.batch.start) * self.n
        return [types.UInt64(dr.gather(types.UInt32, self.weights, place + g)) for g in range(self.n)]

    def count_fired(self, engine, batch) -> None:
        """After a batch: the power that left, summed from the lines' side."""
        types, replicate = engine.types, engine.replicate(batch.numbers)
        place, fires = (dr.arange(types.UInt32, dr.width(batch.numbers)) + batch.start) * self.n, batch.counts > 0
        for g in range(self.n):
            power = types.UInt64(dr.gather(types.UInt32, self.weights, place + g, fires)) * types.UInt64(batch.counts)
            dr.scatter_add(self.fired, power, replicate + g * engine.replicates, active=fires)
        dr.schedule(self.fired)
