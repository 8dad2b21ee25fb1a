"""Lines of sensors on workers: ranges of the lines of each sensor, whose sums are added at a barrier."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from ..problem.model import Problem
from ..sensors.tracing import OfLines, Setup, Tracing
from .barrier import Barrier
from .crew import DaskCrew
from .job import AbstractJob
from .scenes import scene_on
from .worker import job_of, sense

FEWEST = 1 << 17  # lines of a unit


@dataclass(frozen=True, eq=False)
class SensorJob(AbstractJob):
    """What workers need of a measurement, besides the scene.

    Attributes:
        scene: the key of the `SceneJob`.
        setup: the sensors.
    """

    scene: str
    setup: Setup

    @cached_property
    def tracing(self) -> Tracing:
        scene = job_of(self.scene)
        return self.setup.tracing(scene.geometry, scene.problem)

    def sums(self, before: np.ndarray, more: np.ndarray) -> OfLines:
        """Return the sums of lines, on the host."""
        return on_host(self.tracing.sums(before, more))


def on_host(sums: OfLines) -> OfLines:
    """Return copies of sums."""
    met, missed, brought = ([np.array(column) for column in columns] for columns in sums)
    return met, missed, brought


@contextmanager
def sensing(client: Any, tracing: Tracing, problem: Problem, device: str) -> Iterator[None]:
    """Trace the lines of sensors on the workers of a client during a block."""
    scene = scene_on(client, problem, device)
    crew = DaskCrew(client, SensorJob(scene.key, tracing.setup), before=(scene,))
    crew.bring(crew.job)
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
