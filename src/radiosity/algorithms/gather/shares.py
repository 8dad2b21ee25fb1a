"""How many lines of each kind patches fire: a function of N and of what a pilot found, and of nothing else."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .packets import Packets

STORED, FIRST_SHADOW = 16, 8  # cosine lines that are stored, and shadow rays that are fired with them, of a patch at most
FIRST = 16  # of both kinds, in the mean over patches
LEAST = (3, 1)  # of them, however small N is
POWER = 0.435  # errors of a patch fall about as N^-0.65 (variance N^-1.3): shares go as variance to 1 / (1 + 1.3)
FLOOR = 1e-2  # of the mean variance: no patch has none
LARGEST, HALVINGS = 2.0**60, 80  # of factors, which are found by halving an interval
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
        mean = float(means.mean(axis=1).sum())
        weights = (means + FLOOR * mean) ** POWER if mean > 0 else np.ones_like(means)
        return Shares(packets, weights / float((weights * packets.sizes).sum()))

    @property
    def stored_quanta(self) -> int:
        """N up to which all cosine lines are stored, and none reads anything."""
        return FIRST * self.packets.n

    def counts(self, quanta: int) -> np.ndarray:
        """Return how many cosine lines and shadow rays the patches of each packet have fired at N, (2, count) int64.

        It never falls as N grows.
        """
        first = self._shared(min(quanta, self.stored_quanta), np.array([[LEAST[0]], [LEAST[1]]]), (STORED, FIRST_SHADOW))
        return first if quanta <= self.stored_quanta else self._shared(quanta, first, (np.inf, np.inf))

    def stored(self, quanta: int) -> np.ndarray:
        """Return how many cosine lines of the patches of each packet are stored at N, (count,) int64."""
        return self.counts(min(quanta, self.stored_quanta))[0]

    def _shared(self, quanta: int, least: np.ndarray, most: tuple[float, float]) -> np.ndarray:
        """Return counts in proportion to the weights, within limits, that sum to N."""
        limit, low, high = np.array(most)[:, None], 0.0, LARGEST
        for _ in range(HALVINGS):  # a larger N takes the same way or turns up earlier, so counts never fall
            middle = (low + high) / 2 if low else high / 1024
            if float((np.clip(middle * self.weights, least, limit) * self.packets.sizes).sum()) <= quanta:
                low = middle
            else:
                high = middle
        return np.clip(np.floor(low * self.weights + self._phases), least, limit).astype(np.int64)

    @cached_property
    def _phases(self) -> np.ndarray:
        """The phase at which each packet rounds up, (count,) float64 in [0, 1): evenly spread, so that lines are N."""
        return np.arange(self.packets.count) * ((5**0.5 - 1) / 2) % 1.0

    def lines(self, quanta: int) -> int:
        """Return the number of lines of a replicate at N."""
        return int((self.counts(quanta) * self.packets.sizes).sum())

    def corrections(self, quanta: int) -> list[int]:
        """Return each N up to this one at which the reflected radiosity that lines read is corrected."""
        found, at = [], self.stored_quanta
        while at <= quanta:
            found.append(at)
            at *= GROWTH
        return found
