"""Wavefronts of one run on several workers: ranges of lines, whose hits are summed at a barrier."""

from collections.abc import Iterator

from ..algorithms.firing.elsewhere import AbstractFirer, Hits, Lines, cut
from .barrier import Barrier
from .crew import DaskCrew
from .worker import fire, fire_all

FEWEST = 1 << 17  # lines of a unit: smaller ones are given to fewer workers, and wavefronts of fewer than two are fired here


class DaskFirer(AbstractFirer):
    """Fires the lines of a wavefront on the workers of a crew, in proportion to the rates at which these have traced before."""

    def __init__(self, crew: DaskCrew):
        self.barrier = Barrier(crew, fire, lambda lines: list(fire_all(crew.job, lines)))
        self.least = 2 * FEWEST

    def fire(self, lines: list[Lines]) -> Iterator[Hits]:
        barrier, total = self.barrier, sum(one.total for one in lines)
        chosen = sorted(barrier.workers(), key=lambda address: -barrier.rate(address))[: max(1, total // FEWEST)]
        units = [one for one in cut(lines, [barrier.rate(address) for address in chosen] or [1.0]) if one]
        yield from barrier.done(units, lambda unit: sum(one.total for one in unit))
        self.over = barrier.over
