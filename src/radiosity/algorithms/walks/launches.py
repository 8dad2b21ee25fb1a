"""Algorithms that follow walks until they end, in launches of up to a million; between launches their state is whole."""

from abc import abstractmethod
from typing import Any, TypeVar

from ...tracing.lanes import Batch, Launch, chunk
from ..base import AbstractAlgorithm, Swept
from .state import AbstractLaunchState

S = TypeVar("S", bound=AbstractLaunchState)


class AbstractWalks(AbstractAlgorithm[S]):
    """Runs stages made of launches. ``quanta`` is the number of walks of a replicate."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self._quanta, self._before, self._done, self._finished = 0, 0, 0, True
        self._prepare()

    @abstractmethod
    def _prepare(self) -> None:
        """Make the counters."""

    @abstractmethod
    def _sources(self, before: int, quanta: int) -> tuple[Batch | None, int]:
        """Return the walks of a stage, and the largest index among them."""

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
        batch, largest = self._sources(self._before, self._quanta)
        if batch is not None:
            whole = chunk(self.geometry.device.types)
            for launch in batch.launches(self.geometry.device.types, self._done * whole):
                lines = self._follow(launch, largest)
                self._done += -(-launch.lanes // whole)
                swept(lines)
        self._finished = True

    def capture(self) -> S:
        before, done = (None, None) if self._finished else (self._before, self._done)
        return self._state(sizes=self.sizes, quanta=self._quanta, quanta_before=before, launches=done)

    def restore(self, state: S) -> None:
        self._put_back(state)
        self._quanta = state.quanta
        self._before = state.quanta if state.quanta_before is None else state.quanta_before
        self._done, self._finished = state.launches or 0, not state.unfinished
