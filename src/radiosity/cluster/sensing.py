"""Lines of sensors on workers: ranges of the lines of each sensor, whose sums are added at a barrier."""

import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from ..device.backend import choose
from ..problem.model import Problem
from ..sensors.tracing import OfLines, Setup, Tracing
from ..tracing.geometry import Geometry
from .barrier import Barrier
from .crew import DaskCrew
from .worker import sense

FEWEST = 1 << 17  # lines of a unit


@dataclass(frozen=True, eq=False)
class SensorJob:
    """What workers need of a measurement.

    Attributes:
        problem, setup: the scene, and the sensors.
        device: the name of the device that the run is of.
        key: the name of the job on workers.
    """

    problem: Problem
    setup: Setup
    device: str
    key: str = field(default_factory=lambda: uuid.uuid4().hex)

    @cached_property
    def tracing(self) -> Tracing:
        return self.setup.tracing(Geometry(self.problem.patches, choose(self.device)), self.problem)

    def sums(self, before: np.ndarray, more: np.ndarray) -> OfLines:
        """Return the sums of lines, on the host."""
        return on_host(self.tracing.sums(before, more))

    def __getstate__(self) -> dict:
        """Leave out what is made on each machine."""
        return {name: value for name, value in vars(self).items() if name != "tracing"}


def on_host(sums: OfLines) -> OfLines:
    """Return copies of sums."""
    met, missed, brought = ([np.array(column) for column in columns] for columns in sums)
    return met, missed, brought


@contextmanager
def sensing(client: Any, tracing: Tracing, problem: Problem, device: str) -> Iterator[None]:
    """Trace the lines of sensors on the workers of a client during a block."""
    crew = DaskCrew(client, SensorJob(problem, tracing.setup, device))
    crew.register()
    barrier = Barrier(crew, sense, lambda counts: [tracing.sums(*counts)])
    sizes = tracing.receivers.sizes * tracing.receivers.replicates

    def lines_of(counts: tuple[np.ndarray, np.ndarray]) -> int:
        return int((counts[1] * sizes).sum())

    def elsewhere(before: np.ndarray, more: np.ndarray) -> Iterator[OfLines]:
        parts = max(1, min(len(barrier.workers()), lines_of((before, more)) // FEWEST))
        ends = [more * at // parts for at in range(parts + 1)]
        yield from barrier.done([(before + low, high - low) for low, high in pairwise(ends)], lines_of)

    tracing.elsewhere = elsewhere
    try:
        yield
    finally:
        tracing.elsewhere = None
        crew.release()
