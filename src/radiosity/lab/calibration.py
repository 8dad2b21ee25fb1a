"""The calibration of error bars: how often the true value lies inside the stated intervals; not in the paper."""

from dataclasses import dataclass

import numpy as np

from ..algorithms.table import make
from ..device.backend import choose
from ..problem.model import Problem
from ..solution.intervals import student
from ..tracing.geometry import Geometry
from .measure import radiosity
from .study import Arm, Case

LEVELS = (0.5, 0.9, 0.95, 0.99)
REPLICATES = 8  # of one run, which is the default
SEEDS = 60
LINES = 16_000  # of one replicate


@dataclass(frozen=True)
class Coverage:
    """The coverage of an arm's intervals.

    Attributes:
        arm: its name.
        covered: for each of `LEVELS`, the share of patches and runs whose interval holds the truth, and its standard error (over
            runs, since patches of one run share lines).
        rms: root mean square error of the runs' means.
        visited: share of the patches that are counted.
    """

    arm: str
    covered: tuple[tuple[float, float], ...]
    rms: float
    visited: float


def coverage(
    arm: Arm, case: Case, truth: np.ndarray, seed: int, *, lines: float = LINES, seeds: int = SEEDS, visited: float = 0
) -> Coverage:
    """Return the coverage of Student intervals of runs of eight replicates each; a run is a group of replicates of one seed.

    Args:
        truth: (n_patches,) radiosity.
        lines: of one replicate.
        visited: leave out patches with fewer hits in the mean run; those that reflect nothing are left out, too.

    Raises:
        ValueError: no patch is left.
    """
    problem, geometry = Problem.of(case.patches), Geometry(case.patches, choose("cpu"))
    algorithm = make(geometry, problem, arm.method, seed, REPLICATES * seeds)
    mean = float(case.patches.area @ case.patches.reflectance[:, 0] / case.patches.area.sum())
    algorithm.advance(max(1, round(lines * (1 - mean))), lambda lines: None)
    state = algorithm.capture()
    lit = (case.patches.reflectance[:, 0] > 0) & (truth > case.patches.emission[:, 0])  # others are known exactly
    here = lit & (algorithm.tally.arrivals(problem, state) >= visited * seeds)
    if not here.any():
        raise ValueError(f"no patch of {case.name} has {visited:g} arrivals a run")
    found = radiosity(algorithm, problem, state).reshape(seeds, REPLICATES, -1)[..., here]
    middle, error = found.mean(axis=1), found.std(axis=1, ddof=1) / np.sqrt(REPLICATES)
    known = error > 0
    apart = np.where(known, np.abs(middle - truth[here]) / np.where(known, error, 1), np.inf)
    covered = []
    for level in LEVELS:
        share = (apart <= student(level, REPLICATES)).mean(axis=1)
        covered.append((float(share.mean()), float(share.std(ddof=1) / np.sqrt(seeds))))
    rms = float(np.sqrt(((middle - truth[here]) ** 2).mean()))
    return Coverage(arm.name, tuple(covered), rms, float(here.mean()))
