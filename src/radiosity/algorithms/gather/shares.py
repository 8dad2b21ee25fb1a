"""How many lines of each kind patches fire: a function of N and of what a pilot found, and of nothing else."""

from dataclasses import dataclass

import numpy as np

from .packets import Packets

STORED, FIRST_SHADOW = 16, 8  # cosine lines and shadow rays that every patch fires first
LEAST = (2, 1)  # of them, however small N is
POWER = 0.435  # errors of a patch fall about as N^-0.65 (variance N^-1.3): shares go as variance to 1 / (1 + 1.3)
FLOOR = 1e-3  # of the mean variance: no patch has none
GROWTH = 4  # the reflected radiosity that lines read is corrected each time that N has grown by this factor


@dataclass(frozen=True, eq=False)
class Shares:
    """The plan of a run.

    Attributes:
        packets: the lanes.
        weights: (2, count) float64, shares of cosine lines and of shadow rays of each packet, relative to each other.
    """

    packets: Packets
    weights: np.ndarray

    @staticmethod
    def of(packets: Packets, variance: np.ndarray, importance: np.ndarray) -> "Shares":
        """Make it from variances of lines of patches, (2, n), and how much the squared error of a patch counts, (n,)."""
        means = packets.by_packet(variance * importance) / packets.sizes
        weights = (means + FLOOR * means.mean(axis=1).sum()) ** POWER if means.any() else np.ones_like(means)
        return Shares(packets, weights / max(float((weights * packets.sizes).sum()), 1e-300))

    @property
    def stored_quanta(self) -> int:
        """N from which on lines are shared out; below, each patch fires as many as any other, and all cosine lines are stored."""
        return (STORED + FIRST_SHADOW) * self.packets.n

    def counts(self, quanta: int) -> np.ndarray:
        """Return how many cosine lines and shadow rays the patches of each packet have fired at N, (2, count) int64.

        It never falls as N grows.
        """
        if quanta <= self.stored_quanta:
            lines = np.floor(quanta / self.packets.n + self._phases).astype(np.int64)  # of both kinds
            rays = np.maximum(lines * FIRST_SHADOW // (STORED + FIRST_SHADOW), LEAST[1])
            return np.stack([np.maximum(lines - rays, LEAST[0]), rays])
        first = np.array([[STORED], [FIRST_SHADOW]])
        return np.maximum(first, np.floor(self._scale(quanta - self.stored_quanta) * self.weights).astype(np.int64))

    def stored(self, quanta: int) -> np.ndarray:
        """Return how many cosine lines of the patches of each packet are stored at N, (count,) int64."""
        return np.minimum(self.counts(quanta)[0], STORED)

    @property
    def _phases(self) -> np.ndarray:
        """The phase at which each packet rounds up, (count,) float64 in [0, 1): evenly spread, so that the number of lines is N."""
        return np.arange(self.packets.count) * ((5**0.5 - 1) / 2) % 1.0

    def lines(self, quanta: int) -> int:
        """Return the number of lines of a replicate at N."""
        return int((self.counts(quanta) * self.packets.sizes).sum())

    def _scale(self, left: float) -> float:
        """Return the factor s with which max(s w - first, 0) of all patches sums to a number of lines."""
        first = np.array([STORED, FIRST_SHADOW])
        begins = (first[:, None] / self.weights).ravel()  # from this factor on, a packet fires more than its first lines
        order = np.argsort(begins, kind="stable")
        begins, slope = begins[order], np.cumsum((self.weights * self.packets.sizes).ravel()[order])
        constant = np.cumsum((np.repeat(first[:, None], self.packets.count, axis=1) * self.packets.sizes).ravel()[order])
        reached = slope * begins - constant
        at = max(int(np.searchsorted(reached, left, side="right")) - 1, 0)
        return float((left + constant[at]) / slope[at])

    def corrections(self, quanta: int) -> list[int]:
        """Return each N up to this one at which the reflected radiosity that lines read is corrected."""
        found, at = [], self.stored_quanta
        while at <= quanta:
            found.append(at)
            at *= GROWTH
        return found
