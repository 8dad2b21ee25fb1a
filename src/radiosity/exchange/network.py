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

from ..factors.counted import CountedPairs
from ..factors.counts import WORD, split
from ..factors.solve import of_both_ways


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

    Attributes:
        area: (n_patches,) m².
        counts: (m,) lines of each pair, of all replicates.
        lost: (n_patches,) share of a patch's lines that ended on absorbing backs.
        lines: (n_patches,) lines that left each patch.
    """

    def __init__(self, pairs: CountedPairs):
        n = len(pairs.patches)
        self.area, self.replicates = pairs.patches.area, pairs.replicates
        rows, columns = split(pairs.keys)
        self._replicate = rows // n
        keys = ((rows % n).astype(np.uint64) << WORD) | columns.astype(np.uint64)
        self._keys, self._place = np.unique(keys, return_inverse=True)
        self._each = pairs.counts
        self.counts = np.bincount(self._place, weights=pairs.counts, minlength=len(self._keys))
        rows, columns = split(self._keys)
        self.lines = np.bincount(rows, self.counts, n)
        backs = columns == n + 1
        self.lost = np.bincount(rows[backs], self.counts[backs], n) / np.maximum(self.lines, 1)

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
        n = len(labels)
        rows, columns = split(self._keys)
        found = columns <= n  # not those absorbed by backs
        ends = np.append(labels, k)[columns[found]]
        counts = np.bincount(labels[rows[found]] * (k + 1) + ends, self.counts[found], k * (k + 1)).reshape(k, k + 1)
        counts[:, :k] += counts[:, :k].T.copy()
        return counts

    def _network(self, counts: np.ndarray) -> Network:
        from scipy.sparse import coo_array

        n = len(self.area)
        found = of_both_ways(self._keys, counts, n, self.area)
        apart = found.rows != found.columns
        rows, columns = found.rows[apart], found.columns[apart]
        one = coo_array((self.area[rows] * found.values[apart], (rows, columns)), shape=(n, n)).tocsr()
        exchange = ((one + one.T) / 2).tocsr()
        exchange.eliminate_zeros()
        return Network(exchange, self.area * found.escaped, self.area)
