"""Exact form factors of polygons, times how much of the one the other sees."""

import numpy as np

from ..engine.geometry import Geometry
from ..engine.problem import Problem
from ..engine.visibility import Polygons, visible_share
from ..method import Baseline
from .factors import exchange
from .line_rows import LineRows
from .rows import AbstractRows, Rows, Swept

PAIRS = 1 << 16  # at a time
MISSED_LINES = 2048  # of a patch, to learn what share of its light escapes or is lost


class PolygonRows(AbstractRows):
    """F_ij = (exact factor without obstacles) * (visible share of the pair)."""

    def __init__(self, geometry: Geometry, problem: Problem, method: Baseline, seed: int, replicates: int):
        self.geometry, self.samples, self.seed = geometry, method.lines_of_pair, seed
        patches = problem.patches
        self.polygons, self.area, self.normal = Polygons.of(patches), patches.area, patches.normal
        self.missed = LineRows(geometry, problem, method, seed, replicates, MISSED_LINES)
        self.resolved = 1e-9 * np.ptp(self.polygons.corners.reshape(-1, 3), axis=0).max()
        self.symmetric = not geometry.some_backs_pass

    @property
    def at_once(self) -> int:
        return max(PAIRS // len(self.area), 1)

    def make(self, numbers: np.ndarray, replicate: int, swept: Swept) -> Rows:
        rows, columns, values, lines = [], [], [], 0
        for at in range(0, len(numbers), self.at_once):
            some = np.arange(at, min(at + self.at_once, len(numbers)))
            row, other = (x.ravel() for x in np.meshgrid(some, np.arange(len(self.area)), indexing="ij"))
            row, other, value = self.pairs(numbers[row], other, replicate, label=row)
            rows, columns, values = [*rows, row], [*columns, other], [*values, value / self.area[numbers[row]]]
            lines += len(row) * self.samples
            swept(len(row) * self.samples)
        missed = self.missed.make(numbers, replicate, swept)
        row, column, value = (np.concatenate(x) for x in (rows, columns, values))
        return Rows.of(numbers, row, column, value, missed.escaped, missed.lost, lines + missed.lines)

    def pairs(self, one: np.ndarray, other: np.ndarray, replicate: int, label: np.ndarray):
        """Of pairs of patches that exchange light: label, other patch and A_i F_ij, m²."""
        facing = self._facing(one, other)
        one, other, label = one[facing], other[facing], label[facing]
        value = exchange(self.polygons.corners[one], self.polygons.corners[other])
        some = value > 0
        one, other, label, value = one[some], other[some], label[some], value[some]
        ends = self.polygons.take(one), self.polygons.take(other)
        share = visible_share(self.geometry, *ends, self.samples, self.seed + (replicate << 32))
        seen = share > 0
        return label[seen], other[seen], (value * share)[seen]

    def _facing(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Mask: some corner of each is in front of the other's plane; cheap, and leaves out half of all pairs or more."""
        corners = self.polygons.corners

        def in_front(a, b):
            way = corners[b] - corners[a][:, :1]
            return (np.einsum("mkx,mx->mk", way, self.normal[a]) > self.resolved).any(axis=1)

        return in_front(one, other) & in_front(other, one)
