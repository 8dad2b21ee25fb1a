"""Rows of form factors from the counted hits of local lines."""

import numpy as np

from ..device.backend import upload
from ..method import Baseline, Method
from ..problem.model import Problem
from ..sampling.streams import Seed
from ..tally.shooter import Shooter
from ..tracing.geometry import Geometry
from .rows import AbstractRows, Rows, Swept

LAUNCH = 1 << 22  # lines at a time


class LineRows(AbstractRows):
    """Rows F_ij = n_ij / n_i of patch i's first n_i lines; the k-th is a function of seed, replicate, i and k (contract 2)."""

    def __init__(
        self, geometry: Geometry, problem: Problem, method: Baseline, seed: Seed | int, replicates: int, lines: int | None = None
    ):
        self.n, self.replicates, self.lines = len(problem.patches), replicates, lines or method.lines_of_patch
        self.shooter = Shooter(geometry, Method(), seed, replicates, 0)

    @property
    def at_once(self) -> int:
        return max(LAUNCH // self.lines, 1)

    def make(self, numbers: np.ndarray, replicate: int, swept: Swept) -> Rows:
        place = np.zeros(self.n, np.int64)
        place[numbers] = np.arange(len(numbers))
        total, width = self.n * self.replicates, self.n + 2
        found: list[np.ndarray] = []

        def pairs(fired: np.ndarray, slots: np.ndarray) -> None:
            slots = slots.astype(np.int64)
            column = np.where(slots < total, slots % self.n, (slots - total) // self.replicates + self.n)
            found.append(place[fired.astype(np.int64) % self.n] * width + column)

        for at in range(0, len(numbers), self.at_once):
            some = numbers[at : at + self.at_once]
            counts = np.zeros(total, np.uint32)
            counts[replicate * self.n + some] = self.lines
            types = self.shooter.types
            self.shooter.sequences.fired = upload(types.UInt32, np.zeros(total, np.uint32))  # each row begins with its first line
            self.shooter.shoot(upload(types.UInt32, counts), pairs=pairs)
            swept(len(some) * self.lines)
        keys, counts = np.unique(np.concatenate(found) if found else np.zeros(0, np.int64), return_counts=True)
        row, column, share = keys // width, keys % width, counts / self.lines
        escaped, lost = (np.bincount(row[column == code], share[column == code], len(numbers)) for code in (self.n, self.n + 1))
        inside = column < self.n
        return Rows.of(numbers, row[inside], column[inside], share[inside], escaped, lost, len(numbers) * self.lines)
