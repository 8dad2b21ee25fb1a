"""A first shot: the lights' own power goes out by local lines, so that global lines only carry what has been reflected.

Global lines find small lights rarely. With a first shot they start from the power that it left everywhere (Sbert, Pueyo,
Neumann, Purgathofer 1996).
"""

from dataclasses import replace

import numpy as np

from ...method.model import Method
from ...problem.bands import QUANTUM, BandGroups
from ...problem.model import Problem
from ...tracing.geometry import Geometry
from ..firing import state as counters
from ..firing.counters import Engine
from ..firing.orders import run as fire_all
from ..process import State, Swept

PREFIX = "shot_"
APART = 1 << 64  # added to the seed: local lines do not repeat the numbers of global ones


class FirstShot:
    """Counters of the lines from the lights, of all replicates."""

    def __init__(self, geometry: Geometry, problem: Problem, method: Method, seed: int, replicates: int):
        self.source, self.groups = problem.source, problem.groups
        black = np.zeros_like(self.groups.reflectance)
        groups = BandGroups(self.groups.index, self.groups.scale, self.groups.emission, black)
        source = replace(self.source, rho=np.zeros_like(self.source.rho))
        local = Method(numbers=method.points, randomisation=method.randomisation)
        self.engine = Engine(geometry, source, local, seed + APART, replicates, groups)

    def fire(self, lines: int, swept: Swept) -> None:
        """Send each replicate's lights' power in so many lines, those fired before included."""
        if lines != self.engine.quanta:
            self.engine.set_quanta(lines)
        fire_all("breadth-first", self.engine, swept)

    def capture(self) -> State:
        return {PREFIX + name: values for name, values in counters.capture(self.engine).items()}

    def restore(self, state: State) -> None:
        counters.restore(self.engine, {k.removeprefix(PREFIX): v for k, v in state.items() if k.startswith(PREFIX)})


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
