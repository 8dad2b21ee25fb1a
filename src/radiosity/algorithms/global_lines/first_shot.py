"""A first shot: local lines send the lights' own power, so that global lines only carry what has been reflected.

Global lines hit small lights rarely. With a first shot they start from the power that it left everywhere (Sbert, Pueyo,
Neumann, Purgathofer 1996).
"""

from dataclasses import replace
from typing import TypeVar

import numpy as np

from ...errors import MethodError
from ...method.model import Method
from ...problem.bands import QUANTUM
from ...problem.model import Problem
from ...sampling.streams import Seed
from ...solution.books import exact_sum
from ...tracing.geometry import Geometry
from ..base import Swept
from ..firing import state as firing_state
from ..firing.counters import FiringCounters
from ..firing.orders import fire_all
from ..firing.state import FiringState
from ..state import Arrays, Sizes
from .state import MultipathState, PoolingState

Kind = TypeVar("Kind", MultipathState, PoolingState)

APART = 1 << 64  # added to the seed: local lines do not repeat the numbers of global ones


class FirstShot:
    """Counters of the lines from the lights, of all replicates."""

    def __init__(self, geometry: Geometry, problem: Problem, method: Method, seed: Seed | int, replicates: int):
        rows, source = problem.rows, problem.source
        black = replace(
            problem,
            groups=replace(problem.groups, reflectance=np.zeros_like(problem.groups.reflectance)),
            rows=replace(rows, reflectance=np.zeros_like(rows.reflectance)),
            source=replace(source, rho=np.zeros_like(source.rho)),
        )
        local = Method(numbers=method.points, randomisation=method.randomisation)
        self.counters = FiringCounters(geometry, black, local, Seed.of(seed).moved(APART), replicates)

    def fire(self, lines: int, swept: Swept) -> None:
        """Send the power of the lights of each replicate in ``lines`` lines, including those fired before."""
        if lines != self.counters.quanta:
            self.counters.set_quanta(lines)
        fire_all("breadth-first", self.counters, swept)

    def capture(self) -> FiringState:
        return firing_state.capture(self.counters)

    def restore(self, state: FiringState) -> None:
        firing_state.restore(self.counters, state)


def whole(shot: FiringState | None) -> bool:
    """Return True where there was no shot, or where it has the powers of bands if there are several."""
    return shot is None or shot.sizes.groups == 1 or shot.bands is not None


def read(kind: type[Kind], arrays: Arrays, sizes: Sizes, *, shot: bool, lacks: str) -> Kind:
    """Return the state of an algorithm that may have a first shot, from a file's arrays.

    Raises:
        MethodError: arrays are missing or damaged: the solution ``lacks`` what it should hold.
    """
    wanted = ("shot",) if shot else ()
    if not kind.lacking(arrays, sizes, wanted):
        state = kind.read(arrays, sizes, wanted)
        if whole(state.shot):
            return state
    raise MethodError(f"the solution to go on from lacks {lacks}; start anew")


def fired(shot: FiringState | None) -> int:
    """Return the lines of all replicates; 0 where there was no first shot."""
    return 0 if shot is None else exact_sum(shot.fired)


def arrivals(shot: FiringState | None) -> np.ndarray | int:
    """Return the hit counts, (n_patches,) int64, or 0 where there was no first shot."""
    return 0 if shot is None else shot.arrivals.sum(axis=0, dtype=np.int64)


def landed(problem: Problem, shot: FiringState, group: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the power of a group that hit, (replicates, n_patches), and that escaped and was lost, (2, replicates), W or lm."""
    unit = problem.source.power / shot.quanta
    if shot.bands is not None:
        unit /= QUANTUM
        at = (..., group)
        return shot.bands.about("received", at) * unit, shot.bands.about("received_missed", at) * unit
    return shot.arrivals * unit, shot.missed * unit


def lines_for(share: float, spans_lines: float) -> int:
    """Return how many local lines of a replicate are this share of all lines, where the others are ``spans_lines``."""
    return max(1, round(spans_lines * share / (1 - share)))
