"""Rows of form factors from hemicubes."""

import numpy as np

from ..method import Baseline
from ..problem.model import Problem
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry
from .hemicube import Hemicube
from .rows import AbstractRows, Rows, Swept

LAUNCH = 1 << 20  # lines between two readings of the clock


class HemicubeRows(AbstractRows):
    """A hemicube on the middle of each patch, see `factors.hemicube`."""

    def __init__(self, geometry: Geometry, problem: Problem, method: Baseline, seed: Seed | int, replicates: int):
        self.geometry = geometry
        self.cubes = [Hemicube(method.resolution, method.rotated, seed, replicate) for replicate in range(replicates)]

    @property
    def at_once(self) -> int:
        return max(LAUNCH // self.cubes[0].lines, 1)

    def make(self, numbers: np.ndarray, replicate: int, swept: Swept) -> Rows:
        cube, parts = self.cubes[replicate], []
        for at in range(0, len(numbers), self.at_once):
            some = numbers[at : at + self.at_once]
            parts.append((at, cube.rows(self.geometry, some)))
            swept(len(some) * cube.lines)
        row = np.concatenate([factors.rows + at for at, factors in parts])
        columns, values, escaped, lost = (
            np.concatenate([getattr(f, name) for _, f in parts]) for name in ("columns", "values", "escaped", "lost")
        )
        return Rows.of(numbers, row, columns, values, escaped, lost, len(numbers) * cube.lines)
