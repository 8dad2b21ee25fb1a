"""What the solutions of a run have in common, and how one is made of a snapshot."""

from dataclasses import dataclass
from functools import cache
from importlib.metadata import version

from ..algorithms.state import AbstractState
from ..errors import DeviceError
from ..method import Baseline, Method
from ..patches import Patches
from ..solution.model import Solution
from ..tracing.geometry import TRACING
from .part import Part
from .snapshot import Snapshot

LOST_HITS = (
    "the energy balance does not close: hits were lost while another thread of this process ran kernels of Dr.Jit or Mitsuba "
    "(runs of radiosity wait for each other). Solve again while nothing else uses them, or in a process of its own; a checkpoint "
    "of this run is of no use"
)


@dataclass(frozen=True, eq=False)
class Record:
    """The facts that all solutions of a run share: what they come from.

    Attributes:
        patches: of the scene.
        method: the choices.
        part: seed and replicates.
        device: its name.
        budget: as it was given, without what was not.
        choice: what is known of the choice of the method, where it was left to the program.
    """

    patches: Patches
    method: Method | Baseline
    part: Part
    device: str
    budget: dict
    choice: dict | None = None

    @property
    def provenance(self) -> dict:
        """See `Solution.provenance`."""
        return {
            "scene": self.patches.scene.hash,
            "source": self.patches.scene.source,
            "method": str(self.method),
            "choices": self.method.choices,
            **self.part.facts(),
            "device": self.device,
            "patches": len(self.patches),
            "cut": self.patches.hash,
            "tracing": TRACING,
            "budget": self.budget,
            **({} if self.choice is None else {"auto": self.choice}),
            "versions": {name: _version(name) for name in ("radiosity", "drjit", "mitsuba", "numpy")},
        }

    def solution(self, snapshot: Snapshot, status: str, state: AbstractState, seconds: float) -> Solution:
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
            snapshot.lines + int((self.choice or {}).get("pilot_lines", 0)),
            seconds,
            snapshot.quanta,
            self.part.replicates,
            snapshot.books,
            status,
            self.provenance,
            state.arrays(),
            snapshot.surface_power,
            snapshot.side_power,
        )


@cache
def _version(name: str) -> str:
    """Return the version of an installed package; to read it from its files takes milliseconds."""
    return version(name)
