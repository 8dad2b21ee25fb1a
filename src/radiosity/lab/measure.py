"""Measuring an arm on a case: error against lines, replicate by replicate."""

import time
from dataclasses import dataclass

import numpy as np

from ..algorithms.base import AbstractAlgorithm
from ..algorithms.table import make
from ..device.backend import choose
from ..problem.model import Problem
from ..tracing.geometry import Geometry
from .sight import Sight
from .study import Arm, Case, Protocol

PILOT = 1 << 14  # quanta of the pilot run, which tells how many lines a quantum takes


@dataclass(frozen=True, eq=False)
class Series:
    """Errors of an arm on a case.

    Attributes:
        lines: (k,) float64, of one replicate, as the paper counts them (mean over replicates).
        seconds: (k,) float64, of one replicate: wall time from the start divided by replicates, without compilation.
        area_weighted, plain: (replicates, k) float64, RMS of B less the true B; relative where the truth is a reference.
        picture: (replicates, k) float64, the same of tone-mapped pictures; NaN where the scene has no camera.
    """

    lines: np.ndarray
    seconds: np.ndarray
    area_weighted: np.ndarray
    plain: np.ndarray
    picture: np.ndarray


def measure(arm: Arm, case: Case, truth: np.ndarray, protocol: Protocol) -> Series:
    """Run an arm up the ladder; the tally is read at every rung.

    Args:
        truth: (n_patches,) radiosity to compare with.
    """
    problem, geometry = Problem.of(case.patches), Geometry(case.patches, choose("cpu"))
    per_quantum = lines_per_quantum(arm, problem, geometry, protocol)  # and compiles what the run will use
    algorithm = _algorithm(arm, problem, geometry, protocol)
    sight = Sight.of(case.patches)
    lines, seconds, errors, spent, before = [], [], [], 0.0, 0
    for rung in protocol.rungs:
        quanta = max(before + 1, round(rung / per_quantum))
        begun = time.perf_counter()
        algorithm.advance(quanta, _untold)
        spent += time.perf_counter() - begun
        before, state = quanta, algorithm.capture()
        lines.append(algorithm.tally.lines(problem, state) / protocol.replicates)
        seconds.append(spent / protocol.replicates)
        found = radiosity(algorithm, problem, state)
        seen = np.full(protocol.replicates, np.nan) if sight is None else sight.error(found, truth)
        errors.append([*deviations(case, found, truth, absolute=case.exact is not None), seen])
    return Series(np.array(lines), np.array(seconds), *np.transpose(errors, (1, 2, 0)))


def lines_per_quantum(arm: Arm, problem: Problem, geometry: Geometry, protocol: Protocol) -> float:
    """Return the lines that one quantum takes, from a pilot run."""
    algorithm = _algorithm(arm, problem, geometry, protocol)
    algorithm.advance(PILOT, _untold)
    return algorithm.tally.lines(problem, algorithm.capture()) / protocol.replicates / PILOT


def _algorithm(arm: Arm, problem: Problem, geometry: Geometry, protocol: Protocol) -> AbstractAlgorithm:
    return make(geometry, problem, arm.method, protocol.seed, protocol.replicates)


def _untold(lines: int) -> None:
    """Do nothing: progress of the study's runs is not told."""


def radiosity(algorithm: AbstractAlgorithm, problem: Problem, state) -> np.ndarray:
    """Return the radiosity of the first group of bands, (replicates, n_patches)."""
    values, unit = algorithm.tally.irradiance(problem, state, 0)
    patches, groups = problem.patches, problem.groups
    return groups.emission[:, 0] + groups.reflectance[:, 0] * values * (unit / patches.area)


def deviations(case: Case, found: np.ndarray, truth: np.ndarray, *, absolute: bool) -> np.ndarray:
    """Return the RMS of the difference, area-weighted and plain, (2, replicates).

    It is divided by that of the reflected light unless ``absolute``.
    """
    square, area, emitted = (found - truth) ** 2, case.patches.area, case.patches.emission[:, 0]
    weights = area / area.sum(), np.full(len(area), 1 / len(area))
    scale = [1.0 if absolute else float(np.sqrt(w @ (truth - emitted) ** 2)) for w in weights]
    return np.stack([np.sqrt(square @ w) / s for w, s in zip(weights, scale, strict=True)])
