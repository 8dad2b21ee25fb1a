"""The interfaces of algorithms, which run a method stage by stage, and of tallies, which read their states."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from ..patches.bases import CONSTANT, Basis
from ..problem.model import Problem
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry
from .state import AbstractState, Arrays, Sizes

S = TypeVar("S", bound=AbstractState)
Swept = Callable[[int], None]


class Interrupted(Exception):
    """Raised where the state is whole, when the run was asked to stop."""


@dataclass(eq=False)
class AbstractAlgorithm(ABC, Generic[S]):
    """Runs a method: it holds the counters of all replicates, on the device or the host.

    Attributes:
        geometry: the scene on the device.
        problem: the problem to solve.
        method: the method to solve it with.
        seed: the seed of all randomisation, and the number of the first replicate.
        replicates: the number of independent randomised runs.
    """

    geometry: Geometry
    problem: Problem
    method: Any  # a Method, or a Baseline
    seed: Seed | int
    replicates: int

    @property
    def sizes(self) -> Sizes:
        """The sizes of its states."""
        return Sizes(self.replicates, *self.problem.rows.emission.shape)

    @property
    @abstractmethod
    def quanta(self) -> int:
        """N of the stage that began last; 0 at first. The number of lines is proportional to it."""

    @property
    @abstractmethod
    def stage_independent(self) -> bool:
        """True where the state after N depends on N alone, not on the stages that led there."""

    def quanta_for(self, lines: float) -> int | None:
        """Return N of a number of lines of all replicates, where that is known beforehand; None where a pilot must tell."""
        return None

    @abstractmethod
    def advance(self, quanta: int, swept: Swept) -> None:
        """Complete the stage of N quanta a replicate.

        ``swept(lines)`` is called where the state is whole, with the number of lines traced since the last call. An exception of
        it ends the stage early, and `capture` then returns the state so far.
        """

    @abstractmethod
    def capture(self) -> S:
        """Return all that is needed to continue, and to read the result. The state does not change when the run continues."""

    def swept_so_far(self) -> int:
        """Return the number of lines up to now, without those that are traced when results are read."""
        return self.tally.swept_lines(self.problem, self.capture())

    def behind(self) -> float:
        """Return for how many seconds work has been under way, on other machines, that `capture` would lack."""
        return 0.0

    @abstractmethod
    def read(self, arrays: Arrays, sizes: Sizes) -> S:
        """Return the state of a run of this method from the arrays that `AbstractState.arrays` gave.

        Raises:
            MethodError: arrays are missing or of another shape.
        """

    @abstractmethod
    def restore(self, state: S) -> None:
        """Continue from a captured state.

        Raises:
            MethodError: no run can continue from a state of this method.
        """

    @property
    @abstractmethod
    def tally(self) -> "AbstractTally[S]":
        """The tally that reads its states."""


class AbstractTally(ABC, Generic[S]):
    """Reads results from the states of an algorithm.

    Attributes:
        settles: True where, with several replicates, results are quick to read and smaller than the state they are read from.
        counts_hits: True where arrivals are hits, and a patch's power comes with them.
        basis: of the light on patches.
    """

    settles: ClassVar[bool] = False
    counts_hits: ClassVar[bool] = True
    basis: Basis = CONSTANT

    @abstractmethod
    def lines(self, problem: Problem, state: S) -> int:
        """Return the lines of all replicates, as the paper counts them: 1 for a local line, 2 for a span of a global line."""

    def about_lines(self, problem: Problem, state: S) -> float:
        """Return the value of `lines` where it is quick to find, else an estimate."""
        return self.lines(problem, state)

    def swept_lines(self, problem: Problem, state: S) -> int:
        """Return the value of `lines` without lines that are traced when results are read."""
        return self.lines(problem, state)

    def forget(self) -> None:
        """Free the results that were read from a state."""
        return

    @abstractmethod
    def arrivals(self, problem: Problem, state: S) -> np.ndarray:
        """Return the hit count of each patch, replicates together, (n_patches,) int64."""

    @abstractmethod
    def irradiance(self, problem: Problem, state: S, group: int) -> tuple[np.ndarray, float]:
        """Return values of a group of bands, (replicates, n_patches), and their unit.

        Irradiance times area is value times unit.
        """

    def moment(self, problem: Problem, state: S, group: int, function: int) -> np.ndarray:
        """Return moments of a group, (replicates, n_patches), in the unit of `irradiance`: of one of the functions of `basis`.

        Raises:
            IndexError: the basis has no such function; a constant has the mean alone.
        """
        if function:
            raise IndexError(f"function {function} of a basis of one function")
        return self.irradiance(problem, state, group)[0]

    def line(self, problem: Problem, state: S, group: int) -> np.ndarray | float:
        """Return the power that one more line from the lights would bring where it hits, W or lm, one number or (n_patches,).

        It adds to the irradiance times area of a replicate. It is all that is known of patches without hits. Default: the
        largest share that a group has in a quantum.
        """
        return line_of_quanta(problem, state.quanta, group)

    @abstractmethod
    def books(self, problem: Problem, state: S, group: int) -> dict:
        """Return the emitted, rounding, absorbed, escaped and lost power of a group, and ``closes`` (see `Solution.books`)."""


class AbstractBiasedTally(AbstractTally[S]):
    """A tally whose values have a bias of known size."""

    @abstractmethod
    def bias(self, problem: Problem, state: S, group: int) -> np.ndarray:
        """Return the size of the bias of the values' mean, (n_patches,), in the unit of `irradiance`; NaN where unknown.

        Stated standard errors include it.
        """

    def bias_of_sums(self, problem: Problem, state: S, group: int) -> np.ndarray:
        """Return the part of `bias` that sums over whole surfaces have. Default: all of it."""
        return self.bias(problem, state, group)

    def bias_of_moment(self, problem: Problem, state: S, group: int, function: int) -> np.ndarray:
        """Return the size of the bias of a moment's mean, (n_patches,), in the unit of `irradiance`. Default: none."""
        return np.zeros(len(problem.patches))


class AbstractMeanTally(AbstractBiasedTally[S]):
    """A tally of means over the lines of each patch; patches without lines take those of their face (`unmet`)."""

    @abstractmethod
    def measured(self, problem: Problem, state: S) -> np.ndarray:
        """Return the number of lines that each patch's value is the mean of, (replicates, n_patches)."""


def line_of_quanta(problem: Problem, quanta: int, group: int) -> float:
    """Return the largest share that a group has in a quantum of N of any row, a light's among them, W or lm."""
    emission = problem.rows.emission
    largest = emission.max(axis=1)
    share = emission[:, group] / np.where(largest > 0, largest, 1)
    return float(share.max()) * problem.source.power / max(quanta, 1)
