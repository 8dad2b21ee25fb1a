"""What the results of a run have in common, and how one is made of a snapshot."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import ClassVar, Generic

from ..algorithms.state import AbstractState
from ..errors import DeviceError, kept_warnings
from ..method import Baseline, Method
from ..patches import Patches
from ..solution.model import Solution
from ..solution.npz import SOLUTION
from ..solution.without_results import without_results
from ..tracing import coherent_costs
from ..tracing.geometry import TRACING
from .part import Part
from .result import R
from .snapshot import Snapshot

LOST_HITS = (
    "the energy balance does not close: hits were lost while another thread of this process ran kernels of Dr.Jit or Mitsuba "
    "(runs of radiosity wait for each other). Solve again while nothing else uses them, or in a process of its own; a checkpoint "
    "of this run is of no use. If it happens again, lines were left out by a fault of radiosity: report it, please"
)


@dataclass(frozen=True, eq=False)
class AbstractRecord(ABC, Generic[R]):
    """The facts that all results of a run share: what they come from. A class of it says what a run makes of a stage.

    Attributes:
        patches: of the scene.
        method: the choices.
        part: seed and replicates.
        device: its name.
        budget: as it was given, without what was not.
        choice: what is known of the choice of the method, where it was left to the program.
        importance: what lines are shared out for, and the lines of the pilot that found how.
        kind: what the results are called.
        has_errors: True where results have an error, which a run may tell or aim at.
    """

    patches: Patches
    method: Method | Baseline
    part: Part
    device: str
    budget: dict
    choice: dict | None = None
    importance: tuple[str, int] | None = None
    kind: ClassVar[str] = SOLUTION
    has_errors: ClassVar[bool] = True

    @property
    @abstractmethod
    def provenance(self) -> dict:
        """What results come from, see `Solution.provenance`."""

    @abstractmethod
    def result(self, snapshot: Snapshot, status: str, state: AbstractState, seconds: float) -> R:
        """Return the result of a snapshot, with a state to go on from."""

    @abstractmethod
    def unfinished(self, before: R | None, status: str, state: AbstractState, seconds: float) -> R:
        """Return the result of a run that ended within its first stage; ``before`` is what it went on from."""

    def told(self, result: R) -> R:
        """Return the result with the warnings of its run, where results hold them."""
        return result

    @property
    def _run(self) -> dict:
        """The facts of a run, whatever its results are."""
        return {
            "method": str(self.method),
            "choices": self.method.choices,
            **self.part.facts(),
            "device": self.device,
            "patches": len(self.patches),
            "cut": self.patches.hash,
            "tracing": TRACING,
            **coherent_costs.facts(self.method, self.device),
            "budget": self.budget,
            **({} if self.choice is None else {"auto": self.choice}),
            **({} if self.importance is None else dict(zip(("importance", "importance_lines"), self.importance, strict=True))),
            "versions": versions(),
        }


class Record(AbstractRecord[Solution]):
    """The record of a run that solves the equation."""

    @property
    def provenance(self) -> dict:
        scene = self.patches.scene
        return {"scene": scene.hash, "source": scene.source, **self._run}

    def result(self, snapshot: Snapshot, status: str, state: AbstractState, seconds: float) -> Solution:
        """Return the solution of a snapshot, with a state to go on from.

        Raises:
            DeviceError: the energy balance does not close.
        """
        if any(book["closes"] is False for book in snapshot.books):
            raise DeviceError(LOST_HITS)
        mean, error = snapshot.irradiance
        return Solution(
            self.patches,
            mean,
            error,
            snapshot.arrivals,
            snapshot.lines + int((self.choice or {}).get("pilot_lines", 0)) + (self.importance or ("", 0))[1],
            seconds,
            snapshot.quanta,
            self.part.replicates,
            snapshot.books,
            status,
            self.provenance,
            state.arrays(),
            snapshot.surface_power,
            snapshot.side_power,
            kept_warnings(),
            *(snapshot.coefficients or (None, None)),
            snapshot.side_bias,
        )

    def told(self, result: Solution) -> Solution:
        return replace(result, warnings=kept_warnings())

    def unfinished(self, before: Solution | None, status: str, state: AbstractState, seconds: float) -> Solution:
        if before is not None and before.quanta > 0:
            return replace(before, seconds=seconds, status=status, state=state.arrays(), provenance=self.provenance)
        return without_results(self.patches, self.part.replicates, seconds, status, self.provenance, state.arrays())


def versions() -> dict[str, str]:
    """Return the versions of the packages that bits of results depend on."""
    return {name: _version(name) for name in ("radiosity", "drjit", "mitsuba", "numpy")}


@cache
def _version(name: str) -> str:
    """Return the version of a package, ``unknown`` where it is not installed: to read it from its files takes milliseconds."""
    try:
        return version(name)
    except PackageNotFoundError:  # a source tree on the path is enough to run; what was computed must not be lost here
        return "unknown"
