"""Lines of a `Shooter` that are fired elsewhere: cut into ranges, whose hits and powers are whole numbers, and are summed."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..device.backend import frozen, upload
from .elsewhere import AbstractElsewhere
from .scores import Ends, Load


@dataclass(frozen=True, eq=False)
class Shot:
    """Lines of some patch numbers.

    Attributes:
        sequence: whose points they take.
        numbers: (k,) uint32, ascending.
        fired, counts: (k,) uint32, lines that each has fired before, and fires now.
        weights: (k, n_columns), what its lines carry, see `Shooter.shoot`; None where both ends score.
        density, carried, groups: of `Ends`; None where one end scores.
    """

    sequence: int
    numbers: np.ndarray
    fired: np.ndarray
    counts: np.ndarray
    weights: np.ndarray | None
    density: np.ndarray | None = None
    carried: np.ndarray | None = None
    groups: int | None = None

    @property
    def total(self) -> int:
        return int(self.counts.sum(dtype=np.int64))

    def between(self, low: int, high: int) -> "Shot":
        """Return the lines from the ``low``-th to below the ``high``-th of all."""
        some, first, counts = between(self.counts, low, high)
        weights = None if self.weights is None else self.weights[some]
        fired = self.fired[some] + first.astype(np.uint32)
        return replace(self, numbers=self.numbers[some], fired=fired, counts=counts.astype(np.uint32), weights=weights)


@dataclass(frozen=True, eq=False)
class Landed:
    """What lines brought: hit counts, (replicates, n) and (2, replicates), and power, (slots * n_columns,) int64."""

    arrivals: np.ndarray
    missed: np.ndarray
    received: np.ndarray


Shots = AbstractElsewhere[Shot, Landed]


def between(counts: np.ndarray, low: int, high: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return which entries have lines from the ``low``-th to below the ``high``-th of all, the first of each, and how many."""
    begins = np.cumsum(counts, dtype=np.int64) - counts
    first, end = np.maximum(begins, low), np.minimum(begins + counts, high)
    some = np.flatnonzero(first < end)
    return some, (first - begins)[some], (end - first)[some]


def shoot_elsewhere(shooter: Any, shots: Shots, numbers, counts, load: Load) -> int:
    """Fire lines of a `Shooter` elsewhere, and add what they bring.

    Args:
        numbers, counts: of the patch numbers that fire, UInt32 each.
        load: what the lines carry; without receivers.
    """
    types, rows, now = shooter.types, frozen(numbers), frozen(counts)
    carried = None if load.weights is None else frozen(load.weights).reshape(shooter.total, -1)[rows]
    fired = frozen(shooter.sequences.fired).copy()
    shot = Shot(shooter.sequences.taken, rows.copy(), fired[rows], now.copy(), carried)
    if load.ends is not None:
        ends = load.ends
        shot = replace(shot, density=frozen(ends.density), carried=frozen(ends.carried), groups=ends.groups)
    received = frozen(shooter.scores.received).copy()
    arrivals, missed = (column.astype(np.uint64) for column in shooter.hits.read())
    for landed in shots.trace(shot):
        received += landed.received
        arrivals += landed.arrivals
        missed += landed.missed
    fired[rows] += now
    shooter.scores.received, shooter.sequences.fired = upload(types.Int64, received), upload(types.UInt32, fired)
    shooter.hits.write(arrivals, missed)
    return shot.total


def shoot_here(shooter: Any, shot: Shot) -> Landed:
    """Fire lines with a `Shooter` that is of use for nothing else."""
    types, tracer = shooter.types, shooter.tracer
    shooter.sequences.take(shot.sequence)
    fired, counts = np.zeros(shooter.total, np.uint32), np.zeros(shooter.total, np.uint32)
    fired[shot.numbers], counts[shot.numbers] = shot.fired, shot.counts
    shooter.hits.write(np.zeros((tracer.replicates, tracer.n), np.uint32), np.zeros((2, tracer.replicates), np.uint32))
    shooter.sequences.fired = upload(types.UInt32, fired)
    weights: Any = None
    ends: Any = None
    if shot.weights is not None:
        every = np.zeros((shooter.total, shot.weights.shape[1]), shot.weights.dtype)
        every[shot.numbers] = shot.weights
        weights = upload({"i4": types.Int, "i8": types.Int64, "f4": types.Float}[every.dtype.str[1:]], every)
    if shot.density is not None and shot.carried is not None:
        ends = Ends(upload(types.Float, shot.density), upload(types.Float, shot.carried), shot.groups)
    shooter.shoot(upload(types.UInt32, counts), weights, ends)
    arrivals, missed = shooter.hits.read()
    return Landed(arrivals.copy(), missed.copy(), frozen(shooter.scores.received).copy())
