"""A first shot: the lights' own power goes out by local lines, so that global lines only carry what has been reflected.

Global lines find small lights rarely. With a first shot they start from the power that it left everywhere (Sbert, Pueyo,
Neumann, Purgathofer 1996).
"""

from dataclasses import replace

import numpy as np

from ...method.model import Method
from ...problem.bands import QUANTUM
from ...problem.model import Problem
from ...tracing.geometry import Geometry
from ..base import State, Swept
from ..firing import state as firing_state
from ..firing.counters import FiringCounters
from ..firing.orders import fire_all

PREFIX = "shot_"
APART = 1 << 64  # added to the seed: local lines do not repeat the numbers of global ones


class FirstShot:
    """Counters of the lines from the lights, of all replicates."""

    def __init__(self, geometry: Geometry, problem: Problem, method: Method, seed: int, replicates: int):
        rows, source = problem.rows, problem.source
        black = replace(
            problem,
            groups=replace(problem.groups, reflectance=np.zeros_like(problem.groups.reflectance)),
            rows=replace(rows, reflectance=np.zeros_like(rows.reflectance)),
            source=replace(source, rho=np.zeros_like(source.rho)),
        )
        local = Method(numbers=method.points, randomisation=method.randomisation)
        self.counters = FiringCounters(geometry, black, local, seed + APART, replicates)

    def fire(self, lines: int, swept: Swept) -> None:
        """Send each replicate's lights' power in so many lines, those fired before included."""
        if lines != self.counters.quanta:
            self.counters.set_quanta(lines)
        fire_all("breadth-first", self.counters, swept)

    def capture(self) -> State:
        return {PREFIX + name: values for name, values in firing_state.capture(self.counters).items()}

    def restore(self, state: State) -> None:
        firing_state.restore(self.counters, {k.removeprefix(PREFIX): v for k, v in state.items() if k.startswith(PREFIX)})


def fired(state: State) -> int:
    """Lines of all replicates, of a captured state; 0 where there was no shot."""
    return int(state[PREFIX + "fired"].sum(dtype=np.uint64)) if PREFIX + "fired" in state else 0


def arrivals(state: State) -> np.ndarray | int:
    """(n_patches,) int64 landings, or 0."""
    return state[PREFIX + "arrivals"].sum(axis=0, dtype=np.int64) if PREFIX + "fired" in state else 0


def landed(problem: Problem, state: State, group: int) -> tuple[np.ndarray, np.ndarray]:
    """Power of a group, W or lm: (replicates, n_patches) that landed, and (2, replicates) escaped and lost."""
    unit = problem.source.power / int(state[PREFIX + "quanta"])
    if PREFIX + "received" in state:
        unit /= QUANTUM
        return state[PREFIX + "received"][..., group] * unit, state[PREFIX + "received_missed"][..., group] * unit
    return state[PREFIX + "arrivals"] * unit, state[PREFIX + "missed"] * unit


def lines_for(share: float, spans_lines: float) -> int:
    """Local lines of a replicate that are this share of all, where the others are ``spans_lines``."""
    return max(1, round(spans_lines * share / (1 - share)))
