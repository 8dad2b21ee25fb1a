"""A run's state on disk every now and then, so that no more is lost than what came since."""

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import MethodError, OutputError, RadiosityWarning
from ..method import Baseline, Method
from ..solution.model import Solution
from ..solution.saving import save
from ..solution.whole import check_place

EVERY = 30.0  # seconds
TIMES = 30  # as long as it takes to write is gone on for at least: 3 % of the time
RATE = 60e6  # bytes a second that a disk is taken to write at, before it has been measured
WHOLE = {
    "full-matrix": "a full matrix is made whole or not at all",
    "hierarchical": "hierarchical radiosity keeps no links in its results",
}


def resumable(method: "Method | Baseline") -> bool:
    """Runs of this method can go on from what was written."""
    return method.machine not in WHOLE


@dataclass(eq=False)
class Checkpoint:
    """Where, and how often.

    Attributes:
        path: .npz, which `load_solution` reads.
        every: seconds between two of them; longer where writing takes long.
        written: this run has written it.
    """

    path: Path
    every: float = EVERY
    written: bool = False
    _due: float = field(init=False)
    _sized: bool = field(init=False, default=False)
    _warned: bool = field(init=False, default=False)

    def __post_init__(self):
        self._due = time.monotonic() + self.every

    def check(self, method: "Method | Baseline") -> None:
        """Refuse what could not be written, or not be gone on from, before the run.

        Raises:
            MethodError: the method has no state to go on from. OutputError: no place to write to.
        """
        if not resumable(method):
            raise MethodError(f"checkpoint: {WHOLE[method.machine]}: there is nothing to go on from; leave it out")
        if self.path.suffix.lower() != ".npz":
            raise OutputError(f"{self.path}: a checkpoint is an .npz file; give it that suffix")
        check_place(self.path)

    @property
    def due(self) -> bool:
        return time.monotonic() >= self._due

    def write(self, solution: Callable[[], Solution]) -> None:
        """Between two sweeps, and unless writing would take too much of the time so far. A failure is told once, and the run
        goes on: what was written before stays."""
        begun = time.monotonic()
        what = solution()
        if not self._sized:
            self._sized = True
            expected = TIMES * sum(array.nbytes for array in what.state.values()) / RATE
            if expected > self.every:
                self._due += expected - self.every
                return
        self._save(what)
        now = time.monotonic()
        self._due = now + max(self.every, TIMES * (now - begun))

    def end(self, solution: Solution) -> None:
        """The run ends. Of a complete one it is written only where there is one to bring up to date: its results go elsewhere."""
        if self.written or solution.status != "complete":
            self._save(solution)

    def _save(self, solution: Solution) -> None:
        try:
            save(solution, self.path, derived=False)
        except OutputError as error:
            if not self._warned:
                warnings.warn(
                    f"no checkpoint: {error}; the run goes on, and an earlier one stays", RadiosityWarning, stacklevel=2
                )
            self._warned = True
        else:
            self.written = True
