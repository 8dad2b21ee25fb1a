"""A network of conductances between patches, made from counted lines.

Patches i and j exchange A_i F_ij (J_i - J_j) watts, where J is radiosity, and a patch and the surroundings A_i e_i (J_i - M_s)
(A. K. Oppenheim, "Radiation analysis by the network method", Trans. ASME 78, 1956). A_i F_ij is symmetric to the last bit. So
heat is neither made nor lost, and equal temperatures exchange exactly nothing, whatever the lines.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..factors.balance import scaling
from ..factors.counted import CountedPairs
from ..factors.counts import WORD, split
from ..factors.solve import SCALINGS


@dataclass(frozen=True, eq=False)
class Network:
    """Conductances, in m² (times W/m² they are W).

    Attributes:
        exchange: (n, n) scipy CSR array, A_i F_ij = A_j F_ji; nothing on the diagonal.
        escaping: (n,) A_i times the share of lines that escape.
        area: (n,) m².
    """

    exchange: Any
    escaping: np.ndarray
    area: np.ndarray

    @cached_property
    def whole(self) -> np.ndarray:
        """Sum of all conductances of each patch, (n,) m²."""
        return np.asarray(self.exchange.sum(axis=1)).ravel() + self.escaping

    def given_off(self, radiosity: np.ndarray, surroundings: float) -> np.ndarray:
        """Return W that leave each patch for good, (n,), for radiosities (n,) and what black surroundings emit, W/m²."""
        return self.whole * radiosity - self.exchange @ radiosity - self.escaping * surroundings

    def between(self, radiosity: np.ndarray, surroundings: float, labels: np.ndarray, k: int) -> np.ndarray:
        """Return W from one group of patches to another, (k + 1, k + 1), antisymmetric; the last one is the surroundings.

        Args:
            labels: (n,) the group of each patch, below k.
        """
        pairs = self.exchange.tocoo()
        watts = pairs.data * (radiosity[pairs.row] - radiosity[pairs.col])
        result = np.zeros((k + 1, k + 1))
        result[:k, :k] = np.bincount(labels[pairs.row] * k + labels[pairs.col], watts, k * k).reshape(k, k)
        result[:k, :k] = (result[:k, :k] - result[:k, :k].T) / 2  # each was summed in another order
        result[:k, k] = np.bincount(labels, self.escaping * (radiosity - surroundings), k)
        result[k] = -result[:, k]
        return result


class Pooled:
    """Counted lines of all replicates together, and of all but one.

    A line between patches counts for both directions, as in `factors.solve.of_both_ways`. Which pairs there are is found once.

    Attributes:
        area: (n_patches,) m².
        counts: (m,) lines of each key, of all replicates.
        lost: (n_patches,) share of a patch's lines that ended on absorbing backs.
        lines: (n_patches,) lines that left each patch.
    """

    def __init__(self, pairs: CountedPairs):
        n = len(pairs.patches)
        self.area, self.replicates = pairs.patches.area, pairs.replicates
        rows, columns = split(pairs.keys)
        self._replicate, self._each = rows // n, pairs.counts
        keys, self._place = np.unique(((rows % n).astype(np.uint64) << WORD) | columns.astype(np.uint64), return_inverse=True)
        self.counts = np.bincount(self._place, weights=pairs.counts, minlength=len(keys))
        self._rows, self._columns = split(keys)
        self.lines = np.bincount(self._rows, self.counts, n)
        self.lost = self._share(self.counts, n + 1)

        self._apart = (self._columns < n) & (self._columns != self._rows)
        rows, columns = self._rows[self._apart], self._columns[self._apart]
        low, high = np.minimum(rows, columns).astype(np.uint64), np.maximum(rows, columns).astype(np.uint64)
        both, self._pair = np.unique((low << WORD) | high, return_inverse=True)
        self._low, self._high = split(both)
        # each pair stands twice in the symmetric matrix
        rows, columns = np.r_[self._low, self._high], np.r_[self._high, self._low]
        self._order = np.lexsort((columns, rows))
        self._indices = columns[self._order]
        self._begin = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=n))])
        self._order %= max(len(both), 1)

    @cached_property
    def network(self) -> Network:
        """The network of all lines."""
        return self._network(self.counts)

    def without_one(self) -> Iterator[Network]:
        """Yield the networks of all lines but those of one replicate, for each replicate; none where there is one alone."""
        for replicate in range(self.replicates if self.replicates > 1 else 0):
            own = self._replicate == replicate
            counts = self.counts - np.bincount(self._place[own], weights=self._each[own], minlength=len(self.counts))
            yield self._network(counts)

    def between(self, labels: np.ndarray, k: int) -> np.ndarray:
        """Return how many lines joined two groups, in both directions, (k, k + 1); the last column is lines that escaped."""
        found = self._columns <= len(labels)  # not those absorbed by backs
        ends = np.append(labels, k)[self._columns[found]]
        keys = labels[self._rows[found]] * (k + 1) + ends
        counts = np.bincount(keys, self.counts[found], k * (k + 1)).reshape(k, k + 1)
        counts[:, :k] += counts[:, :k].T.copy()
        return counts

    def _share(self, counts: np.ndarray, code: int) -> np.ndarray:
        """Share of each patch's lines that ended at the column ``code``."""
        n, here = len(self.area), self._columns == code
        lines = np.bincount(self._rows, counts, n)
        return np.bincount(self._rows[here], counts[here], n) / np.maximum(lines, 1)

    def _network(self, counts: np.ndarray) -> Network:
        """Conductances by both ends of each line, scaled until those of a patch, and what escapes, sum to its area."""
        from scipy.sparse import csr_array

        n = len(self.area)
        escaped, lost = self._share(counts, n), self._share(counts, n + 1)
        density = np.bincount(self._rows, counts, n) / self.area
        trust = density[self._low] + density[self._high]
        joined = np.bincount(self._pair, counts[self._apart], len(trust))
        value = np.divide(joined, trust, out=np.zeros(len(trust)), where=trust > 0)
        exchange = csr_array((value[self._order], self._indices, self._begin), shape=(n, n))
        missed = self.area * (escaped + lost)  # counted as well, and scaled as `factors.balance.restored` does
        scale = scaling(lambda d: d * (exchange @ d + missed), self.area, SCALINGS)
        value *= scale[self._low] * scale[self._high]
        exchange = csr_array((value[self._order], self._indices, self._begin), shape=(n, n))
        return Network(exchange, self.area * escaped * scale, self.area)
