"""Counted lines between patches: they are made once from the geometry alone, and solved for any emission and reflectance."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..patches.model import Patches
from ..patches.scatter import Scatter
from ..tally.unmet import means, sides
from .counts import WORD, split
from .model import Factors
from .solve import irradiance, of_both_ways, of_own_light, of_rows

ENTRY = 36  # bytes of an entry of form factors, and of its place in a sparse array
KEPT = 1 << 28  # bytes


@dataclass(frozen=True, eq=False)
class Received:
    """The power that the patches of a scene receive, in each replicate.

    Attributes:
        power: (replicates, n_patches) W or lm.
        missed: (replicates, 2) W or lm, escaped and absorbed by backs.
        bias: (replicates, n_patches) W or lm, how much too high ``power`` may be, see `solve.of_own_light`.
    """

    power: np.ndarray
    missed: np.ndarray
    bias: np.ndarray


@dataclass(frozen=True, eq=False)
class CountedPairs:
    """Lines between patches, replicates apart. Nothing in it depends on emission or reflectance.

    Attributes:
        patches: the patches that lines join; only their geometry is used.
        keys: (m,) uint64, ascending: (r n + i) 2^32 + j for lines from patch i to j in replicate r; j = n are lines that escaped,
            and j = n + 1 lines absorbed by backs.
        counts: (m,) uint32 or uint64, the number of lines of each key.
        replicates: the number of replicates.
        both_ways: each line counts at both its ends, see `solve.of_both_ways`.
        directed: a patch need not see a patch that sees it, see `Factors.sent`.
        keeps: form factors are made once and kept for the next light, unless they take more than `KEPT` bytes.
    """

    patches: Patches
    keys: np.ndarray
    counts: np.ndarray
    replicates: int
    both_ways: bool
    directed: bool = False
    keeps: bool = False

    @cached_property
    def lines(self) -> np.ndarray:
        """Lines that left each patch, (replicates, n_patches) float64."""
        rows, _ = split(self.keys)
        shape = (self.replicates, len(self.patches))
        return np.bincount(rows, weights=self.counts, minlength=shape[0] * shape[1]).reshape(shape)

    @cached_property
    def arrivals(self) -> np.ndarray:
        """Lines that hit each patch, replicates together, (n_patches,) int64."""
        n, (_, columns) = len(self.patches), split(self.keys)
        return np.bincount(columns, weights=self.counts, minlength=n + 2)[:n].astype(np.int64)

    def factors(self) -> Iterator[Factors]:
        """Yield the form factors of each replicate."""
        entries = len(self.keys) * (2 if self.both_ways else 1)
        return iter(self._kept) if self.keeps and entries * ENTRY <= KEPT else self._made()

    @cached_property
    def _kept(self) -> list[Factors]:
        return list(self._made())

    def _made(self) -> Iterator[Factors]:
        n = len(self.patches)
        bounds = np.searchsorted(self.keys, np.arange(self.replicates + 1).astype(np.uint64) * np.uint64(n) << WORD)
        for replicate, (begin, end) in enumerate(pairwise(bounds)):
            keys, counts = self.keys[begin:end] - (np.uint64(replicate * n) << WORD), self.counts[begin:end]
            yield of_both_ways(keys, counts, n, self.patches.area) if self.both_ways else of_rows(keys, counts, n)

    def solve(self, emission: np.ndarray, scatter: Scatter) -> list[Received]:
        """Solve the equation for each band. No line is traced.

        Args:
            emission: (n_patches, n_bands) W/m² or lm/m².
            scatter: what patches send on of the light that they receive, of each band.
        """
        area, side = self.patches.area, sides(self.patches)
        found: list[tuple[list, list, list]] = [([], [], []) for _ in range(emission.shape[1])]
        for lines, factors in zip(self.lines, self.factors(), strict=True):
            seen = factors.sent(area) if self.directed else factors
            fill = not self.directed and not lines.all()  # patches without lines then receive by lines of others

            def filled(received, lines=lines, fill=fill):
                return means(received * lines, lines, side) if fill else received

            for band, ((power, missed, bias), one) in enumerate(zip(found, emission.T, strict=True)):
                column = scatter.column(band)
                received = irradiance(seen, one, column, filled)
                sent = area * (one + column.of(received))
                power.append(area * received)
                missed.append([factors.escaped @ sent, factors.lost @ sent])
                bias.append(area * of_own_light(seen, area, lines, one, column, received, both_ways=self.both_ways))
        return [Received(*(np.array(column) for column in columns)) for columns in found]

    def between(self, labels: np.ndarray) -> np.ndarray:
        """Return form factors between k groups of patches, (replicates, k, k + 2); the last two columns are escaped and lost.

        Args:
            labels: (n_patches,) int, the group of each patch, 0 to k - 1.
        """
        area, k, result = self.patches.area, int(labels.max()) + 1, []
        whole = np.bincount(labels, weights=area, minlength=k)
        for factors in self.factors():
            pairs = labels[factors.rows] * k + labels[factors.columns]
            power = np.bincount(pairs, weights=factors.values * area[factors.rows], minlength=k * k).reshape(k, k)
            missed = [np.bincount(labels, weights=x * area, minlength=k) for x in (factors.escaped, factors.lost)]
            result.append(np.column_stack([power, *missed]) / whole[:, None])
        return np.array(result)
