"""What workers need of a run: it travels once to each worker, as a plugin, and to those that come later as well."""

import platform
import uuid
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

from ..algorithms.table import make
from ..device.backend import choose
from ..device.instructions import instructions
from ..method import Baseline, Method
from ..problem.model import Problem
from ..run.record import versions
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry

INSTRUCTIONS = "instructions"  # a fact of processors, see `facts`


@dataclass(frozen=True, eq=False)
class AbstractJob:
    """What is sent to workers once.

    Attributes:
        key: its name on workers.
    """

    key: str = field(default_factory=lambda: uuid.uuid4().hex, kw_only=True)

    def __getstate__(self) -> dict:
        """Leave out what is made on each machine: values of cached properties."""
        return {one.name: getattr(self, one.name) for one in fields(self)}


@dataclass(frozen=True, eq=False)
class Job(AbstractJob):
    """A problem and the method that solves it.

    Attributes:
        problem: the same numbers for all workers, so that none computes them anew with other last bits.
        method: the choices.
        seed: of the run.
        device: the name of the device that the run is of.
        lines: of each replicate, where the memory of a run grows with them and they are known; else None.
    """

    problem: Problem
    method: Method | Baseline
    seed: Seed
    device: str
    lines: float | None = None

    @cached_property
    def geometry(self) -> Geometry:
        """The scene on the device of this process."""
        return Geometry(self.problem.patches, choose(self.device))

    def algorithm(self, first: int, count: int) -> Any:
        """Return a new algorithm of some replicates."""
        seed = Seed(self.seed.value, self.seed.first_replicate + first)
        return make(self.geometry, self.problem, self.method, seed, count)


def facts() -> dict[str, str]:
    """Return what must be equal on all machines, so that bits are; `INSTRUCTIONS` only where packets of lines hang on them."""
    return {**versions(), "machine": platform.machine(), INSTRUCTIONS: instructions()}
