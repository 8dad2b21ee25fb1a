"""Checkpoints: a run's state is written to disk from time to time, so that only what came since can be lost."""

import math
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..errors import MethodError, OutputError, RadiosityWarning
from ..method import Auto, Baseline, Method
from ..solution.saving import save
from ..solution.whole import check_place
from .held import Hold, free_name, held
from .result import Result

EVERY = 30.0  # seconds
AGAIN = 5.0  # seconds after which a writing that failed is tried again: the disk may have room by then
TIMES = 30  # a run goes on for this many times the time of writing, at least: writing then takes 3 % of the time
RATE = 60e6  # bytes a second that a disk is assumed to write, before it has been measured
WHOLE = {
    "full-matrix": "a full matrix is made whole or not at all",
}


def save_solution(solution, path: Path) -> None:
    """Write a solution without what follows from it."""
    save(solution, path, derived=False)


def resumable(method: "Method | Baseline | Auto") -> bool:
    """Return whether runs of this method can go on from a checkpoint."""
    return method.machine not in WHOLE


@dataclass(eq=False)
class Checkpoint:
    """A checkpoint file, and how often it is written.

    Attributes:
        path: .npz, which `load_solution` reads. Where a run of another process holds it, another name takes its place.
        every: seconds between two writings; longer where writing takes long.
        save: writes a result to a path.
        written: True where this run has written it.
    """

    path: Path
    every: float = EVERY
    save: Callable[[Any, Path], None] = save_solution
    written: bool = False
    _due: float = field(init=False)  # by when it should be written
    _rest: float = field(init=False, default=0.0)  # until when it is not
    _swept: float | None = field(init=False, default=None)  # when the last wavefront ended
    _behind: float = field(init=False, default=0.0)  # seconds of work that it lacks
    _longest: float = field(init=False, default=0.0)  # seconds of a wavefront since it was written
    _sized: bool = field(init=False, default=False)
    _warned: bool = field(init=False, default=False)
    _hold: Hold = field(init=False, default_factory=Hold)

    @classmethod
    def of(cls, given, every, method: "Method | Baseline", save: Callable[[Any, Path], None] = save_solution) -> "Checkpoint":
        """Return a checked checkpoint from what a caller gave: a path, or a `Checkpoint`.

        Raises:
            MethodError: arguments of other types, or there is no state to go on from. OutputError: see `check`.
        """
        if isinstance(given, cls):
            given.check(method)
            return given
        try:
            good = not isinstance(every, bool) and math.isfinite(every) and every >= 0
        except TypeError:
            good = False
        if not good:
            raise MethodError(f"checkpoint_every is {every!r}; it must be a number of seconds")
        try:
            keeper = cls(Path(given), float(every), save)
        except TypeError:
            raise MethodError(f"checkpoint is {given!r}; it must be the path of an .npz file") from None
        keeper.check(method)
        return keeper

    def __post_init__(self):
        self._due = time.monotonic() + self.every

    def check(self, method: "Method | Baseline | Auto") -> None:
        """Refuse, before the run, a checkpoint that could not be written, or from which no run could go on.

        Raises:
            MethodError: the method has no state to go on from. OutputError: there is no place to write to.
        """
        if not resumable(method):
            raise MethodError(f"checkpoint: {WHOLE[method.machine]}: there is nothing to go on from; leave it out")
        if self.path.suffix.lower() != ".npz":
            raise OutputError(f"{self.path}: a checkpoint is an .npz file; give it that suffix")
        check_place(self.path)
        self._make_way()

    def due(self, behind: float = 0.0) -> bool:
        """Return whether to write it now; asked after each wavefront.

        It is written before another wavefront, as long as the longest since the last writing, would end too late.

        Args:
            behind: seconds of work under way that it would lack: the next one is written as much earlier.
        """
        now = time.monotonic()
        if self._swept is not None:
            self._longest = max(self._longest, now - self._swept)
        self._swept, self._behind = now, behind
        return now >= self._rest and now + self._longest >= self._due

    def write(self, solution: Callable[[], Result]) -> None:
        """Write the file, unless that would take too much of the time so far; called between two wavefronts.

        A failure is told once, and the run goes on: what was written before stays. It is tried again soon.
        """
        begun = time.monotonic()
        what = solution()
        if not self._sized:
            self._sized = True
            expected = TIMES * sum(array.nbytes for array in what.state.values()) / RATE
            if expected > self.every:
                self._due += expected - self.every
                self._rest = self._due
                return
        wait = self.every if self._save(what) else min(self.every, AGAIN)
        self._swept, self._longest = time.monotonic(), 0.0
        self._rest = self._swept + TIMES * (self._swept - begun)
        self._due = max(self._swept + wait - self._behind, self._rest)

    def end(self, solution: Result) -> None:
        """Write the file at the end of a run; that of a complete run only where the run has written one before."""
        if self.written or solution.status != "complete":
            self._save(solution)

    def _make_way(self) -> None:
        """Take another name where a run of another process holds the file: each would be lost by the other's next writing."""
        if self._hold.has(self.path) or not held(self.path):
            return
        other = free_name(self.path)
        warnings.warn(
            f"{self.path}: the checkpoint of a run that goes on in another process; that of this run is {other}",
            RadiosityWarning,
            stacklevel=3,
        )
        self.path = other

    def _save(self, solution: Result) -> bool:
        """Write the file; False where that failed."""
        self._make_way()
        try:
            self.save(solution, self.path)
        except OutputError as error:
            if not self._warned:
                warnings.warn(
                    f"no checkpoint: {error}; the run goes on, and an earlier one stays", RadiosityWarning, stacklevel=2
                )
            self._warned = True
            return False
        self._hold.take(self.path)
        self.written, self._warned = True, False
        return True
