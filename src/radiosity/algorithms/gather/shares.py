"""How many lines of each kind patches fire: a function of N and of what a pilot found, and of nothing else."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .packets import Packets

STORED, FIRST_SHADOW = 16, 8  # cosine lines that are stored, and shadow rays that are fired with them, of a patch at most
FIRST = 16  # of both kinds, in the mean over patches
LEAST = (3, 1)  # of them, however small N is
OF_FUNCTION = 6  # lines of a patch are stored for each function of a basis, if that is more than `STORED`
POWER = 0.435  # errors of a patch fall about as N^-0.65 (variance N^-1.3): shares go as variance to 1 / (1 + 1.3)
FLOOR = 1e-2  # of the mean variance: no patch has none
GROWTH = 4  # the reflected radiosity that lines read is corrected each time that N has grown by this factor


@dataclass(frozen=True, eq=False)
class Factors:
    """The factor of all weights at which clipped counts sum to N: a function that grows with N, straight between corners.

    Attributes:
        corners: (m,) float64, factors at which a count leaves its lower limit or meets its upper one, ascending.
        sums: (m,) float64, the sum of counts at each.
        slopes: (m,) float64, by how much the sum grows with the factor from there on.
    """

    corners: np.ndarray
    sums: np.ndarray
    slopes: np.ndarray

    @staticmethod
    def of(weights: np.ndarray, sizes: np.ndarray, least: np.ndarray, most: np.ndarray) -> "Factors":
        """Make it for counts clip(factor * weights, least, most), each of so many patches."""
        growth = weights * sizes
        ends = np.isfinite(most)
        corners = np.concatenate([(least / weights).ravel(), (most / weights)[ends]])
        changes = np.concatenate([growth.ravel(), -growth[ends]])
        order = np.argsort(corners, kind="stable")
        corners, slopes = corners[order], np.maximum(np.cumsum(changes[order]), 0.0)
        steps = np.concatenate([[0.0], slopes[:-1] * np.diff(corners)])
        return Factors(corners, float((least * sizes).sum()) + np.cumsum(steps), slopes)

    def at(self, quanta: int) -> float:
        """Return the factor at N; 0 where the lower limits alone are more."""
        number = int(np.searchsorted(self.sums, quanta, side="right")) - 1
        if number < 0:
            return 0.0
        begin, slope = float(self.corners[number]), float(self.slopes[number])
        end = float(self.corners[number + 1]) if number + 1 < len(self.corners) else np.inf
        return min(begin + (quanta - float(self.sums[number])) / slope, end) if slope > 0 else begin


@dataclass(frozen=True, eq=False)
class Shares:
    """The plan of a run.

    Attributes:
        packets: the lanes.
        weights: (2, count) float64, shares of cosine lines and of shadow rays of each packet, relative to each other.
        size: how many functions the basis has, K. What m lines say of K coefficients has a relative variance of K / m, and along
            half of the stored lines the solution must exist, too: so patches store 3 K lines at least.
    """

    packets: Packets
    weights: np.ndarray
    size: int = 1

    @staticmethod
    def of(packets: Packets, variance: np.ndarray, importance: np.ndarray, size: int = 1) -> "Shares":
        """Make it from variances of lines of patches, (2, n), and how much the squared error of a patch counts, (n,)."""
        means = packets.by_packet(variance * importance) / packets.sizes
        mean = float(means.mean(axis=1).sum())
        weights = (means + FLOOR * mean) ** POWER if mean > 0 else np.ones_like(means)
        return Shares(packets, weights / float((weights * packets.sizes).sum()), size)

    @property
    def stored_quanta(self) -> int:
        """N up to which all cosine lines are stored, and none reads anything."""
        return self._limits[2] * self.packets.n

    def counts(self, quanta: int) -> np.ndarray:
        """Return how many cosine lines and shadow rays the patches of each packet have fired at N, (2, count) int64.

        It never falls as N grows.
        """
        first = self._counts(min(quanta, self.stored_quanta), *self._first)
        return first if quanta <= self.stored_quanta else self._counts(quanta, *self._later)

    def stored(self, quanta: int) -> np.ndarray:
        """Return how many cosine lines of the patches of each packet are stored at N, (count,) int64."""
        return self.counts(min(quanta, self.stored_quanta))[0]

    def _counts(self, quanta: int, factors: Factors, least: np.ndarray, most: np.ndarray) -> np.ndarray:
        """Return counts in proportion to the weights, within limits, that sum to N."""
        return np.clip(np.floor(factors.at(quanta) * self.weights + self._phases), least, most).astype(np.int64)

    @property
    def _limits(self) -> tuple[tuple[int, int], tuple[int, int], int]:
        """The least and most lines of both kinds of a patch while lines are stored, and their mean number."""
        if self.size == 1:
            return LEAST, (STORED, FIRST_SHADOW), FIRST
        most = max(STORED, OF_FUNCTION * self.size)
        return (most // 2, most // 6), (most, most // 2), most

    @cached_property
    def _first(self) -> tuple[Factors, np.ndarray, np.ndarray]:
        """Factors and limits of the first lines, which are stored."""
        least, most = (np.broadcast_to(np.array(limit, float)[:, None], self.weights.shape) for limit in self._limits[:2])
        return Factors.of(self.weights, self.packets.sizes, least, most), least, most

    @cached_property
    def _later(self) -> tuple[Factors, np.ndarray, np.ndarray]:
        """Factors and limits of all lines of a longer run."""
        least = self._counts(self.stored_quanta, *self._first).astype(float)
        most = np.full_like(least, np.inf)
        return Factors.of(self.weights, self.packets.sizes, least, most), least, most

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
