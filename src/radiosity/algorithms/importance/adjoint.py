"""The importance of patches: the solution of the adjoint equation, and what it is worth.

A result Q = sum_j A_j w_j H_j of the irradiance H is, by reciprocity, also sum_i A_i E_i K_i. K is the irradiance in the same
scene where patches emit w in place of E: what a unit of light that leaves a patch adds to Q, by all ways. So the lines of Q are
shared out well where a patch fires in proportion to the power that it sends and to K (P. Bekaert, "Hierarchical and stochastic
algorithms for radiosity", thesis, K. U. Leuven 1999, chapter 6; J. C. Wagner and A. Haghighat, "Automated variance reduction of
Monte Carlo shielding calculations using the discrete ordinates adjoint function", Nuclear Science and Engineering 128, 1998).

A run of few lines from one end does not reach the other, if that is far. So light and importance are solved in turns, each
shared out by what is known of the other, until both tell the same Q. Lights without area send light, and receive no importance:
theirs follows from what their lines hit (`sources`).
"""

from dataclasses import dataclass, replace

import numpy as np

from ...method import Method
from ...problem.model import Problem
from ...problem.source_rows import SourceRows
from ...sampling.streams import Seed
from ...tracing.geometry import Geometry
from ..iterations.algorithm import Iteration
from .smoothing import Blocks
from .sources import LEAST, FirstHits

ROUNDS = 12  # at most, of light and importance
QUANTA = 1 << 14  # of a round; later ones have more
ALIKE = 0.1  # of Q: light and importance agree
LARGEST = 2.0**26  # of the mean of what emits: so a line has enough units of power
APART = 1 << 40  # between the seed of a run and those of its pilots


@dataclass(frozen=True, eq=False)
class Importance:
    """What a pilot found.

    Attributes:
        values: (n_rows,) float64, positive, of patches, then of lights without area; the mean over emitted power is 1.
        light, adjoint: Q as both ends told it, W or lm: that of the largest band.
        lines: that were traced.
    """

    values: np.ndarray
    light: float
    adjoint: float
    lines: int

    @staticmethod
    def of(geometry: Geometry, problem: Problem, weights: np.ndarray, method: Method, seed: Seed | int) -> "Importance":
        """Find the importance for Q = sum_j A_j w_j H_j.

        Args:
            weights: (n_patches,) w_j, not negative, some of them positive.
            method: the numbers of lines, and their randomisation.
            seed: its value alone counts, so that all replicates have one importance.
        """
        patches, light = problem.patches, problem.scalar
        emission = light.groups.emission[:, 0]
        blocks = Blocks.of(patches)
        base = Seed(Seed.of(seed).value).moved(APART)
        first = FirstHits.of(geometry, light, method, base.moved(ROUNDS))
        adjoint = _emitting(light, weights)
        lights: np.ndarray | None = None  # their importance, once patches have one
        known: list[np.ndarray | None] = [None, None]  # what falls on patches, by each end
        found, lines = [0.0, 0.0], first.lines
        for number in range(ROUNDS):
            end, quanta, draw = number % 2, QUANTA << (number // 4), base.moved(number)
            if end:
                assert known[0] is not None
                shares = normalised(known[0], adjoint)
                power, hits, fired = _irradiance(geometry, adjoint, shares, method, draw, quanta)
                known[1] = blocks.smooth(power, hits)
                mean, lights = first.means(weights + light.groups.scatter.of(known[1][:, None])[:, 0])
                found[1] = float(power @ emission) + float(mean @ first.power)
            else:
                shares = None if known[1] is None or lights is None else normalised(np.append(known[1], lights), light)
                power, hits, fired = _irradiance(geometry, light, shares, method, draw, quanta)
                known[0] = blocks.smooth(power, hits)
                found[0] = float(power @ weights)
            lines += fired
            if end and min(found) > 0 and abs(found[0] - found[1]) <= ALIKE * min(found):
                break
        assert known[1] is not None
        assert lights is not None
        return Importance(normalised(np.append(known[1], lights), light), found[0], found[1], lines)


def normalised(values: np.ndarray, problem: Problem) -> np.ndarray:
    """Return values over their mean over the emitted power of a scalar problem, within limits, all positive.

    Args:
        values: (n_rows,) those of patches are positive; lights without area have `LEAST` or more.
    """
    rows = problem.rows
    mean = float(values @ (rows.emission[:, 0] * rows.area)) / problem.source.power
    found = np.clip(values / mean, 1 / LARGEST, LARGEST) if mean > 0 else np.ones(len(values))
    found[rows.n_patches :] = np.maximum(found[rows.n_patches :], LEAST)
    return found


def _emitting(problem: Problem, emission: np.ndarray) -> Problem:
    """Return a scalar problem with another emission of the patches, and without lights."""
    groups, n = replace(problem.groups, emission=emission[:, None]), len(emission)
    rows = SourceRows(n, groups.emission, groups.reflectance, problem.patches.area, None, groups.through, groups.other)
    power = float(emission @ problem.patches.area)
    return replace(problem, groups=groups, rows=rows, lights=None, source=replace(problem.source, power=power))


def _irradiance(
    geometry, problem: Problem, shares, method: Method, seed: Seed, quanta: int
) -> tuple[np.ndarray, np.ndarray, int]:
    """Return the power that patches receive, (n_patches,) W or lm, their hits, and the number of lines."""
    run = Iteration(geometry, replace(problem, importance=shares), method, seed, 1)
    lines = 0

    def swept(count: int) -> None:
        nonlocal lines
        lines += count

    run.advance(quanta, swept)
    state = run.capture()
    values, unit = run.tally.irradiance(problem, state, 0)
    return values[0] * unit, run.tally.arrivals(problem, state), lines
