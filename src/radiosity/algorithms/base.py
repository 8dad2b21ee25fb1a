"""What runs a method from stage to stage, and how its state is read."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from ..problem.model import Problem
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry
from .state import AbstractState, Arrays, Sizes

S = TypeVar("S", bound=AbstractState)
Swept = Callable[[int], None]


class Interrupted(Exception):
    """The run was asked to stop where its state is whole."""


@dataclass(eq=False)
class AbstractAlgorithm(ABC, Generic[S]):
    """The counters of all replicates of a method, on the device or the host.

    Attributes:
        geometry: the scene on the device.
        problem: what is solved.
        method: how.
        seed: of all randomisation, and the first of its replicates.
        replicates: independent randomised runs.
    """

    geometry: Geometry
    problem: Problem
    method: Any  # a Method, or a Baseline
    seed: Seed | int
    replicates: int

    @property
    def sizes(self) -> Sizes:
        """Of its states."""
        return Sizes(self.replicates, *self.problem.rows.emission.shape)

    @property
    @abstractmethod
    def quanta(self) -> int:
        """N of the stage that was begun last; 0 at first. Lines grow in proportion to it."""

    @property
    @abstractmethod
    def stage_independent(self) -> bool:
        """The state after N depends on N alone, not on the stages that led there."""

    @abstractmethod
    def advance(self, quanta: int, swept: Swept) -> None:
        """Complete the stage of N quanta a replicate. ``swept(lines)`` is called where the state is whole, with the lines traced
        since; what it raises ends the stage early, and `capture` then holds what is there."""

    @abstractmethod
    def capture(self) -> S:
        """All that is needed to go on, and to read the result. The run may go on, and the state stays as it is."""

    @abstractmethod
    def read(self, arrays: Arrays, sizes: Sizes) -> S:
        """The state of a run of this method that `AbstractState.arrays` wrote, with so many replicates.

        Raises:
            MethodError: arrays are missing or of another shape.
        """

    @abstractmethod
    def restore(self, state: S) -> None:
        """Put a captured state back.

        Raises:
            MethodError: there is no going on from a state of this method.
        """

    @property
    @abstractmethod
    def tally(self) -> "AbstractTally[S]":
        """How states are read."""


class AbstractTally(ABC, Generic[S]):
    """What a process's state means.

    Attributes:
        settles: with several replicates, results are quick to read and smaller than the state they are read from.
        counts_hits: arrivals are lines that landed, and a patch's power comes with them.
    """

    settles: ClassVar[bool] = False
    counts_hits: ClassVar[bool] = True

    @abstractmethod
    def lines(self, problem: Problem, state: S) -> int:
        """Lines of all replicates, as the paper counts them: a local line 1, a span of a global line 2."""

    def about_lines(self, problem: Problem, state: S) -> float:
        """The same where it is quick to tell, else an estimate."""
        return self.lines(problem, state)

    def swept_lines(self, problem: Problem, state: S) -> int:
        """The same without lines that are traced where results are read."""
        return self.lines(problem, state)

    def forget(self) -> None:
        """Let go of what was read of a state."""
        return

    @abstractmethod
    def arrivals(self, problem: Problem, state: S) -> np.ndarray:
        """(n_patches,) int64: lines that landed on each patch, replicates together."""

    @abstractmethod
    def irradiance(self, problem: Problem, state: S, group: int) -> tuple[np.ndarray, float]:
        """(replicates, n_patches) values of a group of bands, and their unit: irradiance times area is value times unit."""

    def line(self, problem: Problem, state: S, group: int) -> np.ndarray | float:
        """W or lm that one line more from the lights would bring where it lands, to the irradiance times area of a replicate: one
        number, or (n_patches,). It is what is known of patches where none landed. Default: the largest share that a group has in
        a quantum."""
        return line_of_quanta(problem, state.quanta, group)

    @abstractmethod
    def books(self, problem: Problem, state: S, group: int) -> dict:
        """Emitted, rounding, absorbed, escaped and lost power of a group, and ``closes`` (see `Solution.books`)."""


class AbstractBiasedTally(AbstractTally[S]):
    """A tally whose values have a bias that it can tell the size of."""

    @abstractmethod
    def bias(self, problem: Problem, state: S, group: int) -> np.ndarray:
        """(n_patches,) the size of the bias of the values' mean, in the unit of `irradiance`; NaN where unknown. Stated standard
        errors hold it."""


class AbstractMeanTally(AbstractBiasedTally[S]):
    """A tally of means over the lines of each patch; patches without lines take those of their face (`unmet`)."""

    @abstractmethod
    def measured(self, problem: Problem, state: S) -> np.ndarray:
        """(replicates, n_patches): lines that each patch's value is the mean of."""


def line_of_quanta(problem: Problem, quanta: int, group: int) -> float:
    """W or lm: the largest share that a group has in a quantum of N."""
    largest = problem.groups.emission.max(axis=1)
    share = problem.groups.emission[:, group] / np.where(largest > 0, largest, 1)
    return float(share.max()) * problem.source.power / max(quanta, 1)
