"""Wavefronts that are fired elsewhere: cut into ranges of lines, whose hits are summed when all are back (contract 16).

The lines of a wavefront are fixed before its first is fired. So whoever knows a row, the lines that it has fired, how many it
fires now and what power they carry, can fire them. Hits are whole numbers, and so are powers of bands.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...device.backend import frozen, upload
from ...solution.books import exact_sum
from ...tally.elsewhere import AbstractElsewhere
from ...tally.shots import between
from ...tally.wraps import PERIOD
from ...tracing.lanes import Wavefront


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines of some rows of a replicate.

    Attributes:
        replicate: counted from 0 on within the run.
        rows: (k,) uint32, ascending.
        fired, counts: (k,) whole numbers, lines that each row has fired before, and fires now.
        weights: (k, groups) uint32, the power that its lines carry, see `BandTally`; None where there is one group.
        largest: the largest line number of the wavefront.
        wide: True where line numbers may have more than 32 bits; those of a row then lie in one block of its numbers.
    """

    replicate: int
    rows: np.ndarray
    fired: np.ndarray
    counts: np.ndarray
    weights: np.ndarray | None
    largest: int
    wide: bool = False

    @property
    def total(self) -> int:
        return int(self.counts.sum(dtype=np.int64))


@dataclass(frozen=True, eq=False)
class Hits:
    """What lines of a replicate brought.

    Attributes:
        replicate: as of `Lines`.
        arrivals, missed: (n_rows,) and (2,), hits, and lines that escaped and were lost.
        received, received_missed: (n_rows, groups) and (2, groups) uint64, their power; None where there is one group.
        fired: (n_rows,) lines of each row that were fired after those that were given; None where there are none (`own_rows`).
    """

    replicate: int
    arrivals: np.ndarray
    missed: np.ndarray
    received: np.ndarray | None
    received_missed: np.ndarray | None
    fired: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Begun:
    """The counters of a run of integers at a wavefront of all that is due: what may be fired after it follows from them.

    Attributes:
        quanta: N of the stage.
        arrivals, fired: (replicates, n_rows), hit and fired counts; the lines of the wavefront count as fired.
    """

    quanta: int
    arrivals: np.ndarray
    fired: np.ndarray


@dataclass(frozen=True, eq=False)
class Due:
    """The lines of a wavefront.

    Attributes:
        lines: those of each replicate that has any.
        begun: where it is given, lines that their hits make due may be fired as well.
    """

    lines: list[Lines]
    begun: Begun | None


Firer = AbstractElsewhere[Due, Hits]


def fire_elsewhere(counters: Any, wavefront: Wavefront, largest: int, firer: Firer) -> None:
    """Fire a wavefront, and add its hits to the `FiringCounters`."""
    tracer, bands = counters.tracer, counters.bands
    numbers, counts = _on_host(counters, wavefront)
    fired, some = counters.fired_upper.values(counters.fired).astype(np.uint64), counts > 0
    weights = None if bands is None else frozen(bands.weights).reshape(-1, bands.n)[: wavefront.size][some]
    numbers, counts = numbers[some], counts[some]
    order = np.argsort(numbers, kind="stable")
    numbers, counts, weights = numbers[order], counts[order], None if weights is None else weights[order]
    ends, found = np.searchsorted(numbers, np.arange(1, tracer.replicates + 1) * tracer.n), []
    wide = wavefront.blocks is not None
    for replicate, (low, high) in enumerate(zip([0, *ends[:-1]], ends, strict=True)):
        part, rows = slice(low, high), numbers[low:high] - np.uint32(replicate * tracer.n)
        powers = None if weights is None else weights[part]
        if high > low:
            found.append(Lines(replicate, rows.astype(np.uint32), fired[numbers[part]], counts[part], powers, largest, wide))
    fired[numbers] += counts
    sums, more = _Sums.of(counters), 0
    alone = bands is not None or counters.targets.panes is not None or wide or counters.parted
    begun = None if alone else Begun(counters.quanta, sums.arrivals, fired.reshape(sums.arrivals.shape))
    for hits in firer.trace(Due(found, begun)):
        sums = sums.after(counters, hits)
        if hits.fired is not None:
            fired[hits.replicate * tracer.n : (hits.replicate + 1) * tracer.n] += hits.fired
            more += int(hits.fired.sum(dtype=np.int64))
    sums.put_back(counters)
    counters.fired = upload(type(counters.fired), counters.fired_upper.of(fired))
    if bands is not None and weights is not None:
        for replicate in range(tracer.replicates):
            own = numbers // tracer.n == replicate
            power = weights[own] * counts[own, None].astype(np.uint64)
            for group, column in enumerate(power.T):
                bands.fired_before[group * tracer.replicates + replicate] += exact_sum(column)
    counters.swept += wavefront.total + more
    counters.look()
    counters.look_everywhere()


@dataclass(eq=False)
class _Sums:
    """The counters of a run on the host, while hits come back; they are put back before any could wrap around unseen."""

    arrivals: np.ndarray
    missed: np.ndarray
    received: np.ndarray | None
    lines: int = 0

    @staticmethod
    def of(counters: Any) -> "_Sums":
        bands = counters.bands
        arrivals, missed = (column.astype(np.uint64) for column in counters.hits.read())
        return _Sums(arrivals, missed, None if bands is None else frozen(bands.received).reshape(-1, bands.n).copy())

    def after(self, counters: Any, hits: Hits) -> "_Sums":
        """Return the sums with what lines brought."""
        lines, tracer = int(hits.arrivals.sum(dtype=np.int64)) + int(hits.missed.sum(dtype=np.int64)), counters.tracer
        sums = self
        if self.received is not None and self.lines + lines > PERIOD:
            self.put_back(counters)
            counters.look()
            sums = _Sums.of(counters)
        sums.lines += lines
        sums.arrivals[hits.replicate] += hits.arrivals
        sums.missed[:, hits.replicate] += hits.missed
        if sums.received is not None:
            first = hits.replicate * tracer.n
            sums.received[first : first + tracer.n] += hits.received
            sums.received[tracer.total + hits.replicate :: tracer.replicates] += hits.received_missed
        return sums

    def put_back(self, counters: Any) -> None:
        """Set the counters to the sums."""
        counters.hits.write(self.arrivals, self.missed)
        if counters.bands is not None and self.received is not None:
            counters.bands.received = upload(counters.types.UInt64, self.received)


def cut(lines: list[Lines], shares: list[float]) -> list[list[Lines]]:
    """Return the lines in as many parts as there are shares, in proportion to these; the lines of a row may be in several."""
    total = sum(one.total for one in lines)
    ends = np.rint(np.cumsum(shares) / sum(shares) * total).astype(np.int64)
    return [_between(lines, low, high) for low, high in zip([0, *ends[:-1].tolist()], ends.tolist(), strict=True)]


def _between(lines: list[Lines], low: int, high: int) -> list[Lines]:
    """Return the lines from the ``low``-th to below the ``high``-th of all."""
    found, before = [], 0
    for one in lines:
        some, first, counts = between(one.counts, low - before, high - before)
        before += one.total
        if len(some):
            fired = one.fired[some] + first.astype(one.fired.dtype)
            weights = None if one.weights is None else one.weights[some]
            counts = counts.astype(one.counts.dtype)
            found.append(replace(one, rows=one.rows[some], fired=fired, counts=counts, weights=weights))
    return found


def _on_host(counters: Any, wavefront: Wavefront) -> tuple[np.ndarray, np.ndarray]:
    """Return the row numbers of a wavefront, and how many lines each fires."""
    size = wavefront.size
    numbers: Any = wavefront.numbers
    if numbers is None:
        numbers = np.arange(wavefront.low, wavefront.low + size, dtype=np.uint32)
    else:
        numbers = frozen(numbers)[:size]
    if wavefront.counts is not None:
        return numbers, frozen(wavefront.counts)[:size].copy()
    types = counters.types
    all_rows = upload(types.UInt32, numbers)
    targets = frozen(counters.target_counts_before(all_rows))
    return numbers, targets - frozen(counters.fired)[numbers]
