"""Rows of exact form factors of polygons, times the visible share of each pair."""

from functools import cached_property

import numpy as np

from ..method import Baseline
from ..problem.model import Problem
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry
from ..tracing.visibility import Polygons, visible_share
from .missed import missed
from .polygons import exchange
from .rows import AbstractRows, Rows, Swept

PAIRS = 1 << 16  # at a time


class PolygonRows(AbstractRows):
    """Rows F_ij = (exact factor without obstacles) * (visible share of the pair).

    For a whole matrix see `factors.polygons.matrix.exact`, which makes each pair once.
    """

    def __init__(self, geometry: Geometry, problem: Problem, method: Baseline, seed: Seed | int, replicates: int):
        self.geometry, self.samples, self.seed = geometry, method.lines_of_pair, Seed.of(seed)
        self.polygons, self.area = Polygons.of(problem.patches), problem.patches.area

    @property
    def at_once(self) -> int:
        return max(PAIRS // len(self.area), 1)

    @cached_property
    def missed(self) -> tuple[np.ndarray, np.ndarray]:
        """Shares escaped and lost of all patches."""
        return missed(self.geometry, seed=self.seed.value)

    def make(self, numbers: np.ndarray, replicate: int, swept: Swept) -> Rows:
        rows, columns, values, lines = [], [], [], 0
        for at in range(0, len(numbers), self.at_once):
            some = np.arange(at, min(at + self.at_once, len(numbers)))
            row, other = (x.ravel() for x in np.meshgrid(some, np.arange(len(self.area)), indexing="ij"))
            one = numbers[row]
            value = exchange(self.polygons.corners[one], self.polygons.corners[other])
            faces = np.flatnonzero(value)
            row, one, other, value = row[faces], one[faces], other[faces], value[faces]
            ends = self.polygons.take(one), self.polygons.take(other)
            value *= visible_share(self.geometry, *ends, self.samples, self.seed.number_of(replicate)) / self.area[one]
            seen = value > 0
            rows, columns, values = [*rows, row[seen]], [*columns, other[seen]], [*values, value[seen]]
            lines += len(row) * self.samples
            swept(len(row) * self.samples)
        row, column, value = (np.concatenate(x) for x in (rows, columns, values))
        escaped, lost = (share[numbers] for share in self.missed)
        return Rows.of(numbers, row, column, value, escaped, lost, lines)
