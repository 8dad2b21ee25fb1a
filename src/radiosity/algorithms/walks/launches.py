"""Algorithms that follow walks until they end, in launches of up to a million; between launches their state is whole."""

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from ...tally.elsewhere import AbstractElsewhere
from ...tally.wraps import PERIOD
from ...tracing.lanes import Launch, chunk
from ..adding import added
from ..base import AbstractAlgorithm, Interrupted, Swept
from .source_sampling import Begun
from .state import AbstractLaunchState

S = TypeVar("S", bound=AbstractLaunchState)


@dataclass(frozen=True)
class Chunks:
    """Chunks of the walks of a stage.

    Attributes:
        before, quanta: N of the stage before, and of this one.
        first, end: the first chunk, and the one after the last.
    """

    before: int
    quanta: int
    first: int
    end: int


class AbstractWalksElsewhere(AbstractElsewhere[Chunks, tuple[S, int]]):
    """Follows chunks of walks elsewhere; yields their sums, and the number of their lines."""

    least = 2

    @abstractmethod
    def take(self, chunks: Chunks) -> Chunks:
        """Return as many of the chunks, from the first on, as are to be followed between two moments when the state is whole."""


class AbstractWalks(AbstractAlgorithm[S]):
    """Runs stages made of launches. ``quanta`` is the number of walks of a replicate.

    Attributes:
        elsewhere: follows chunks elsewhere; None: all here.
    """

    elsewhere: AbstractWalksElsewhere[S] | None = None

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self._quanta, self._before, self._done, self._finished = 0, 0, 0, True
        self._unseen = 0  # lines since counters were looked at
        self._end: int | None = None  # the chunk where a part of a stage ends
        self._prepare()

    @abstractmethod
    def _prepare(self) -> None:
        """Make the counters."""

    @abstractmethod
    def _sources(self, before: int, quanta: int) -> Iterator[Begun]:
        """Yield the walks of a stage, block by block."""

    @abstractmethod
    def _enter(self, block: int) -> None:
        """Take the numbers of a block for the next launches."""

    @abstractmethod
    def _look(self) -> None:
        """Note which counters wrapped around."""

    def _chunks(self, begun: Begun, limit: int) -> int:
        """Return the number of chunks of walks that begin together."""
        return -(-begun.batch.total // chunk(self.geometry.device.types))

    def _launches(self, begun: Begun, before: int, done: int, end: int | None, limit: int) -> Iterator[tuple[Any, int | None]]:
        """Yield what `_follow` takes of walks that begin together, and the chunks done with it: None within a chunk.

        Args:
            before: N of the stage before.
            done, end: chunks that were done before, and the one after the last; None for all.
            limit: most lanes of a launch.
        """
        types, whole = self.geometry.device.types, chunk(self.geometry.device.types)
        at = done * whole
        for launch in begun.batch.launches(types, at, None if end is None else end * whole, limit):
            at += launch.lanes
            yield launch, None if at % whole and at < begun.batch.total else -(-at // whole)

    @abstractmethod
    def _follow(self, launch: Launch, largest: int) -> int:
        """Follow all walks of a launch until they end, and return the number of their lines."""

    @abstractmethod
    def _state(self, **progress: Any) -> S:
        """Return the state: the counters on the host, with the given sizes and launches."""

    @abstractmethod
    def _put_back(self, state: S) -> None:
        """Set the counters to those of a captured state."""

    @property
    def quanta(self) -> int:
        return self._quanta

    def advance(self, quanta: int, swept: Swept) -> None:
        if quanta != self._quanta:
            self._before, self._quanta, self._done, self._finished = self._quanta, quanta, 0, False
        passed, lines = 0, 0
        # of very long walks, fewer in a launch, so that no counter wraps around between two looks
        limit = 1 << max(int(2 * PERIOD * self.problem.source.least_absorbed), 2).bit_length() - 1
        for begun in self._sources(self._before, self._quanta):
            chunks = self._chunks(begun, limit)
            self._advance_elsewhere(passed + chunks, swept)
            first, end = min(max(self._done - passed, 0), chunks), None if self._end is None else max(self._end - passed, 0)
            for launch, done in self._launches(begun, self._before, first, end, limit):
                self._enter(begun.block)
                lines += self._follow(launch, begun.largest)
                if done is None:
                    continue  # within a chunk
                self._done, self._unseen = passed + done, self._unseen + lines
                if self._unseen > PERIOD:
                    self._look()
                    self._unseen = 0
                swept(lines)
                lines = 0
            passed += chunks
        self._finished = True

    def _advance_elsewhere(self, end: int, swept: Swept) -> None:
        """Have chunks up to ``end`` followed elsewhere, as long as that pays."""
        elsewhere = self.elsewhere
        while elsewhere is not None and end - self._done >= elsewhere.least:
            taken, total, lines = elsewhere.take(Chunks(self._before, self._quanta, self._done, end)), self.capture(), 0
            for sums, more in elsewhere.trace(taken):
                total, lines = added(total, sums), lines + more
            self._put_back(total)
            self._look()
            self._done = taken.end
            swept(lines)
            if elsewhere.over:
                raise Interrupted("interrupted")

    def follow_chunks(self, chunks: Chunks) -> tuple[S, int]:
        """Return the sums of the walks of some chunks alone, and the number of their lines.

        The algorithm has run nothing before, or has been restored to the state that it began with.
        """
        self._before, self._quanta, self._done, self._finished = chunks.before, chunks.quanta, chunks.first, False
        lines, self._end = 0, chunks.end

        def swept(more: int) -> None:
            nonlocal lines
            lines += more
            if self._done >= chunks.end:
                raise Interrupted

        try:
            self.advance(chunks.quanta, swept)
        except Interrupted:
            pass
        finally:
            self._end = None
        self._finished = True
        return self.capture(), lines

    def capture(self) -> S:
        before, done = (None, None) if self._finished else (self._before, self._done)
        return self._state(sizes=self.sizes, quanta=self._quanta, quanta_before=before, launches=done)

    def restore(self, state: S) -> None:
        self._put_back(state)
        self._quanta = state.quanta
        self._before = state.quanta if state.quanta_before is None else state.quanta_before
        self._done, self._finished = state.launches or 0, not state.unfinished
