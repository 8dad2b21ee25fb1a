"""Steps of one run on several workers: ranges of lines or walks of iterations, drawn walks and gathers, summed at a barrier.

What is fixed before a step begins decides all its lines, and all that they bring are whole numbers. So it does not matter who
traces which of them.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from ..algorithms.base import AbstractAlgorithm
from ..algorithms.firing.algorithm import Firing
from ..algorithms.gather.algorithm import Gather
from ..algorithms.gather.elsewhere import AbstractLinesElsewhere, GatherLines, Sums
from ..algorithms.iterations.algorithm import Iteration
from ..algorithms.walks.launches import AbstractWalks, AbstractWalksElsewhere, Chunks
from ..tally.shots import Landed, Shot, Shots
from .barrier import Barrier
from .crew import DaskCrew
from .wavefronts import FEWEST, DaskFirer, most_lines
from .worker_steps import follow, gather_of, shoot, shot_of, trace, walks_of

AT_A_TIME = 4  # units of each worker between two barriers, where they need not be fewer: an idle one then takes the next
MOST_CHUNKS = 4  # of a unit: some seconds


def cut(whole: AbstractAlgorithm, crew: DaskCrew) -> bool:
    """Have the steps of a run cut among the workers of a crew; return whether its algorithm is of a kind that can be."""
    if isinstance(whole, Firing):
        whole.counters.firer = DaskFirer(crew)
    elif isinstance(whole, Iteration) and not whole.method.refine_lines:
        whole.exchange.shooter.elsewhere = DaskShots(crew, whole.replicates)
    elif isinstance(whole, AbstractWalks):
        whole.elsewhere = DaskWalks(crew, whole.replicates)
    elif isinstance(whole, Gather):
        whole.elsewhere = DaskLines(crew, whole)
    else:
        return False
    return True


class DaskShots(Shots):
    """Fires the lines of iterations."""

    def __init__(self, crew: DaskCrew, replicates: int):
        self.barrier = Barrier(crew, shoot, lambda unit: [shot_of(crew.job, unit)])
        self.replicates, self.least = replicates, 2 * FEWEST

    @property
    def most(self) -> int:
        return most_lines(self.barrier)

    def trace(self, lines: Shot) -> Iterator[Landed]:
        total = lines.total
        parts = max(1, min(len(self.barrier.workers()), total // FEWEST))
        ends = [total * at // parts for at in range(parts + 1)]
        units = [(self.replicates, lines.between(low, high)) for low, high in pairwise(ends)]
        yield from self.barrier.done(units, lambda unit: unit[1].total)
        self.over = self.barrier.over


class DaskWalks(AbstractWalksElsewhere[Any]):
    """Follows chunks of walks."""

    def __init__(self, crew: DaskCrew, replicates: int):
        self.barrier = Barrier(crew, follow, lambda unit: [walks_of(crew.job, unit)])
        self.replicates = replicates

    def take(self, chunks: Chunks) -> Chunks:
        most = AT_A_TIME * MOST_CHUNKS * max(len(self.barrier.workers()), 1)
        return Chunks(chunks.before, chunks.quanta, chunks.first, min(chunks.end, chunks.first + most))

    def trace(self, lines: Chunks) -> Iterator[tuple[Any, int]]:
        workers, count = max(len(self.barrier.workers()), 1), lines.end - lines.first
        parts = min(count, AT_A_TIME * workers if count > AT_A_TIME * workers else workers)
        ends = [lines.first + count * at // parts for at in range(parts + 1)]
        units = [(self.replicates, Chunks(lines.before, lines.quanta, *pair)) for pair in pairwise(ends)]
        yield from self.barrier.done(units, lambda unit: unit[1].end - unit[1].first)
        self.over = self.barrier.over


class DaskLines(AbstractLinesElsewhere):
    """Traces cosine lines and shadow rays of a gather."""

    def __init__(self, crew: DaskCrew, gather: Gather):
        self.barrier = Barrier(crew, trace, lambda unit: [gather_of(crew.job, unit)])
        self.replicates, self.sizes, self.least = gather.replicates, gather.packets.sizes, 2 * FEWEST

    @property
    def slices(self) -> int:
        return max(len(self.barrier.workers()), 1)

    def lines_of(self, lines: GatherLines) -> int:
        return lines.total(self.sizes) * self.replicates

    def trace(self, lines: GatherLines) -> Iterator[Sums]:
        parts = max(1, min(len(self.barrier.workers()), self.lines_of(lines) // FEWEST))
        units = [(self.replicates, part) for part in lines.cut(parts)]
        yield from self.barrier.done(units, lambda unit: self.lines_of(unit[1]))
        self.over = self.barrier.over
