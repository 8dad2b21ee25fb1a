"""Wavefronts of one run on several workers, and what follows from them: ranges of lines, whose hits are summed at a barrier."""

import uuid
from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from ..algorithms.firing.elsewhere import Begun, Due, Firer, Hits, Lines, cut
from ..algorithms.firing.own_rows import OwnRows, dealt
from . import post
from .barrier import Barrier
from .crew import DaskCrew
from .worker import fire, fire_all, fire_own_rows

FEWEST = 1 << 17  # lines of a unit: smaller ones are given to fewer workers, and wavefronts of fewer than two are fired here
LEAST = 1 << 17  # lines of own rows, for each worker that is told of their hits, that must be due before a worker fires them
EACH = {"cpu": 1 << 26, "cuda": 1 << 32}  # lines of a worker between two barriers at most: some seconds
SECONDS = 10.0  # after which workers that fire together come back: what all of them lose where one is killed
ROWS = 64  # of a worker at least, where they have rows of their own: so that each has about as much to fire


class DaskFirer(Firer):
    """Fires the lines of a wavefront on the workers of a crew, in proportion to the rates at which these have traced before.

    Where lines that follow may be fired as well, workers fire those of rows of their own, and send
    hits to each other (`own_rows`).
    """

    def __init__(self, crew: DaskCrew):
        self.barrier = Barrier(crew, fire, lambda lines: list(fire_all(crew.job, lines)))
        self.least = 2 * FEWEST

    @property
    def most(self) -> int:
        return most_lines(self.barrier)

    def trace(self, lines: Due) -> Iterator[Hits]:
        barrier, total = self.barrier, sum(one.total for one in lines.lines)
        chosen = sorted(barrier.workers(), key=lambda address: -barrier.rate(address))[: max(1, total // FEWEST)]
        together = [] if lines.begun is None else self._together(lines.lines, lines.begun, chosen)
        if together:
            yield from together
        else:
            units = [one for one in cut(lines.lines, [barrier.rate(address) for address in chosen] or [1.0]) if one]
            yield from barrier.done(units, lambda unit: sum(one.total for one in unit))
        self.over = barrier.over

    def _together(self, lines: list[Lines], begun: Begun, chosen: list[str]) -> list[Hits]:
        """Return the hits of lines and of what workers fired after them; nothing where a worker was lost, or there are few."""
        crews = [chosen[at :: len(lines)] for at in range(len(lines))]  # of each replicate
        if min(map(len, crews)) < 2 or max(map(len, crews)) * ROWS > begun.arrivals.shape[1]:
            return []
        barrier, client = self.barrier, self.barrier.crew.client
        key, units = uuid.uuid4().hex, {}
        for one, crew in zip(lines, crews, strict=True):
            own = tasks(one, begun, [barrier.rate(address) for address in crew])
            units |= {address: (task, key, crew) for address, task in zip(crew, own, strict=True)}

        def end() -> None:
            with suppress(Exception):  # the scheduler may have gone
                client.run(post.end, key, workers=[*barrier.workers()], wait=False)

        found = barrier.together(units, fire_own_rows, end)
        for brought in found:
            barrier.note(sum(int(hits.arrivals.sum() + hits.missed.sum()) for hits in brought.what), brought)
        return [hits for brought in found for hits in brought.what]


def most_lines(barrier: Barrier) -> int:
    """Return the most lines between two barriers."""
    return EACH[barrier.crew.job.device] * max(len(barrier.workers()), 1)


def tasks(lines: Lines, begun: Begun, rates: list[float]) -> list[OwnRows]:
    """Return the tasks of workers that fire the lines of a replicate together."""
    owners, least, found = dealt(begun.arrivals.shape[1], rates), LEAST * max(len(rates) - 1, 1), []
    arrivals, fired = begun.arrivals[lines.replicate], begun.fired[lines.replicate]
    for own, first in enumerate(cut([lines], rates)):
        rows, given = np.flatnonzero(owners == own), (lines.replicate, begun.quanta, owners, own)
        found.append(OwnRows(first[0] if first else None, *given, arrivals[rows], fired[rows], least, SECONDS))
    return found
