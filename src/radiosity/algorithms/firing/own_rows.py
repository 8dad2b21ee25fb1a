"""Walks on several machines without barriers: each fires the lines of rows of its own, and tells the others their hits.

What a row may fire follows from its hits, and a hit more never takes a line away (an abelian network, contract 2). So whoever
owns a row fires its lines as soon as it knows of enough hits. A hit that it does not know of yet is a line that it fires later,
and one that it is never told of is a line that is due when all hits are summed. The integers in the end are those of every
other order.
"""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...problem.quanta import WORD, Source
from .elsewhere import Hits, Lines

LARGEST = 2**31  # line numbers and hit counts: beyond them counters are wide, and wavefronts end with barriers
GOLDEN = (5**0.5 - 1) / 2


@dataclass(frozen=True, eq=False)
class OwnRows:
    """What one of several machines does for a replicate.

    Attributes:
        lines: what it fires first, of any rows; None for nothing.
        replicate: counted from 0 on within the run.
        quanta: N of the stage.
        owners: (n_rows,) which of the machines fires the lines of each row from then on.
        own: which of them it is.
        arrivals, fired: (k,) hit and fired counts of its rows, ascending, once all machines have fired what they fire first.
        least: lines that must be due before it fires.
        seconds: after which it stops.
    """

    lines: Lines | None
    replicate: int
    quanta: int
    owners: np.ndarray
    own: int
    arrivals: np.ndarray
    fired: np.ndarray
    least: int
    seconds: float

    @property
    def rows(self) -> np.ndarray:
        """Return its rows, (k,) ascending."""
        return np.flatnonzero(self.owners == self.own)


class AbstractPost(ABC):
    """Sends hits to the machines that own the rows, and takes those of others. Nothing waits for it but `wait`."""

    @abstractmethod
    def send(self, hits: list[np.ndarray]) -> None:
        """Send hits to each machine, on the rows that it owns."""

    @abstractmethod
    def take(self) -> np.ndarray | int:
        """Return the hits on own rows that have come since the last call."""

    @abstractmethod
    def wait(self, seconds: float) -> bool:
        """Tell the others that nothing is due here, and wait for hits.

        Returns:
            False where none will come: nothing is due anywhere and no message is under way, or the time is over.
        """


def dealt(n_rows: int, shares: list[float]) -> np.ndarray:
    """Return the owner of each row, (n_rows,) uint16, in proportion to shares.

    Rows beside each other, which are alike, go to different owners: row i to the one in whose share lies the fraction of i
    times the golden ratio.
    """
    ends = np.cumsum(shares)[:-1] / sum(shares)
    return np.searchsorted(ends, np.arange(n_rows) * GOLDEN % 1, side="right").astype(np.uint16)


def fire_own(task: OwnRows, source: Source, phase: np.ndarray, fire: Callable[[Lines], Hits], post: AbstractPost) -> Hits:
    """Fire the first lines of a task, and then what its rows must fire, until nothing is due or the time is over.

    Args:
        source, phase: of the replicate; ``phase`` is (n_rows,).
        fire: fires lines here.

    Returns:
        The hits, with the lines that its rows fired after the first ones.
    """
    begun, rows = time.perf_counter(), task.rows
    others = [np.flatnonzero(task.owners == other) for other in range(int(task.owners.max()) + 1)]
    targets, arrivals, fired = _targets(task, source, phase), task.arrivals.astype(np.uint64), task.fired.astype(np.uint64)
    sums = _Sums(len(task.owners))
    lines = task.lines
    while True:
        if lines is not None:
            hits = fire(lines)
            sums.add(hits)
            arrivals += hits.arrivals[rows]
            post.send([hits.arrivals[other] for other in others])
        arrivals += np.asarray(post.take(), np.uint64)
        goal = targets(arrivals)
        due = goal - fired
        left = task.seconds - (time.perf_counter() - begun)
        if left < 0 or int(goal.max(initial=0)) >= LARGEST or int(arrivals.max(initial=0)) >= LARGEST:
            break
        if int(due.sum()) >= task.least:
            some = np.flatnonzero(due)
            which = rows[some].astype(np.uint32), fired[some], due[some].astype(np.uint32)
            lines = Lines(task.replicate, *which, None, int(goal[some].max()))
            fired[some] = goal[some]
        else:
            lines = None
            if not post.wait(left):
                break
    after = np.zeros(len(task.owners), np.uint64)
    after[rows] = fired - task.fired
    return replace(sums.hits(task.replicate), fired=after)


def _targets(task: OwnRows, source: Source, phase: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Return the function that gives the target counts of own rows for their hit counts, uint64 both; see `problem.quanta`."""
    rows = task.rows
    whole, fraction = (column[rows].astype(np.uint64) for column in source.emitted(task.quanta))
    rho, low = source.rho[rows].astype(np.uint64), fraction + phase[rows].astype(np.uint64)
    return lambda arrivals: whole + ((rho * arrivals + low) >> WORD)


class _Sums:
    """Sums of hits."""

    def __init__(self, n_rows: int):
        self.arrivals, self.missed = np.zeros(n_rows, np.uint64), np.zeros(2, np.uint64)

    def add(self, hits: Hits) -> None:
        self.arrivals += hits.arrivals
        self.missed += hits.missed

    def hits(self, replicate: int) -> Hits:
        return Hits(replicate, self.arrivals, self.missed, None, None)
