"""What is left of a complete stage on the host: counters, and the tallies of the bands."""

from dataclasses import dataclass

import numpy as np

from ..solution.books import Books, exact_dot, exact_sum
from ..solution.errors import mean_and_error
from .bands import QUANTUM, BandGroups
from .firing import Engine
from .quanta import Source


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A complete stage of N quanta.

    Attributes:
        quanta: N.
        arrivals, fired: (replicates, n_patches) uint32.
        missed: (2, replicates) uint32, escaped and lost lines.
        received: (n_groups, replicates, n_patches) uint64, 2^-31 quanta; None where the integers say it all.
        received_missed: (n_groups, 2, replicates) uint64 of the same, escaped and lost.
        fired_power: (n_groups, replicates) Python integers of the same.
    """

    quanta: int
    arrivals: np.ndarray
    fired: np.ndarray
    missed: np.ndarray
    received: np.ndarray | None
    received_missed: np.ndarray | None
    fired_power: np.ndarray | None

    @staticmethod
    def of(engine: Engine) -> "Snapshot":
        """Copy an engine's counters."""
        arrivals, fired, missed = engine.counters()
        if engine.bands is None:
            return Snapshot(engine.quanta, arrivals, fired, missed, None, None, None)
        flat = np.stack([np.array(a) for a in engine.bands.received])
        received = flat[:, : engine.total].reshape(-1, engine.replicates, engine.n)
        missed_power = flat[:, engine.total :].reshape(-1, 2, engine.replicates)
        return Snapshot(engine.quanta, arrivals, fired, missed, received, missed_power, engine.bands.fired.copy())

    @property
    def lines(self) -> int:
        return int(self.fired.sum(dtype=np.uint64))

    def irradiance(self, source: Source, area: np.ndarray, group: int) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard error, (n_patches,) each, of a group of bands."""
        counts = self.arrivals if self.received is None else self.received[group]
        unit = source.power / self.quanta / (1 if self.received is None else QUANTUM)
        mean, error = mean_and_error(counts.astype(np.float64))
        return mean * (unit / area), error * (unit / area)

    def books(self, source: Source, groups: BandGroups, group: int, area: np.ndarray) -> Books:
        """Of a group of bands."""
        replicates = len(self.arrivals)
        rho = Source.fixed(groups.reflectance[:, group])
        if self.received is None:
            counts, missed, fired, unit = self.arrivals, self.missed, exact_sum(self.fired), 1
            whole, fraction = source.emitted(self.quanta)
            emitted = ((exact_sum(whole) << 32) + exact_sum(fraction)) * replicates
        else:
            assert self.received_missed is not None and self.fired_power is not None
            counts, missed, fired, unit = self.received[group], self.received_missed[group], int(self.fired_power[group].sum()), QUANTUM
            share = groups.emission[:, group] * area / source.power
            emitted = round(float(share.sum()) * self.quanta * QUANTUM) * replicates << 32
        reflected = sum(exact_dot(row, rho) for row in counts)
        arrived = exact_sum(counts) << 32
        return Books(emitted, fired << 32, reflected, arrived - reflected, exact_sum(missed[0]) << 32, exact_sum(missed[1]) << 32,
                     source.power / self.quanta / unit / 2**32 / replicates)  # fmt: skip
