"""Processes that follow walks to their ends, a launch of up to a million at a time; between launches their state is whole."""

from abc import abstractmethod

import numpy as np

from ...tracing.lanes import Batch, Launch
from ..base import AbstractAlgorithm, State, Swept


class AbstractWalks(AbstractAlgorithm):
    """Stages made of launches. ``quanta`` is the number of walks of a replicate."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self._quanta, self._before, self._done, self._finished = 0, 0, 0, True
        self._prepare()

    @abstractmethod
    def _prepare(self) -> None:
        """Make the counters."""

    @abstractmethod
    def _sources(self, before: int, quanta: int) -> tuple[Batch | None, int]:
        """Walks of a stage, and the largest index among them."""

    @abstractmethod
    def _follow(self, launch: Launch, largest: int) -> int:
        """All walks of a launch, to their ends: how many lines they took."""

    @abstractmethod
    def _counts(self) -> State:
        """The counters on the host."""

    @abstractmethod
    def _put_back(self, state: State) -> None:
        """Counters from a captured state."""

    @property
    def quanta(self) -> int:
        return self._quanta

    def advance(self, quanta: int, swept: Swept) -> None:
        if quanta != self._quanta:
            self._before, self._quanta, self._done, self._finished = self._quanta, quanta, 0, False
        batch, largest = self._sources(self._before, self._quanta)
        if batch is not None:
            for at, launch in enumerate(batch.launches(self.geometry.device.types)):
                if at >= self._done:
                    lines = self._follow(launch, largest)
                    self._done = at + 1
                    swept(lines)
        self._finished = True

    def capture(self) -> State:
        state = {"quanta": np.array(self._quanta)} | self._counts()
        if not self._finished:
            state |= {"quanta_before": np.array(self._before), "launches": np.array(self._done)}
        return state

    def restore(self, state: State) -> None:
        self._put_back(state)
        self._quanta = int(state["quanta"])
        self._before, self._done = int(state.get("quanta_before", self._quanta)), int(state.get("launches", 0))
        self._finished = not self.unfinished(state)

    def unfinished(self, state: State) -> bool:
        return "launches" in state
