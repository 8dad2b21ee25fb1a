"""The reflected radiosity of a solution, replicate by replicate: what the lines of sensors read."""

import numpy as np

from ..algorithms.table import make
from ..method import Method
from ..problem.model import Problem
from ..sampling.streams import Seed
from ..solution.model import Solution
from ..tracing.geometry import Geometry


def reflected(solution: Solution, geometry: Geometry, problem: Problem) -> np.ndarray:
    """Return B - E of each replicate, (replicates, n_patches, n_groups * K) float64, in shares of `Problem.unit`.

    With a basis of K functions a group has K coefficients. A solution without replicates has one.
    """
    unit = np.maximum(problem.unit, 1e-300)
    if solution.by_baseline or solution.replicates < 2:
        return mean_reflected(solution, problem)[None]
    facts = solution.provenance
    seed = Seed(facts["seed"], facts.get("first_replicate", 0))
    method = Method(**facts["choices"])
    own = problem  # that of the run: the rows of lines through openings are among its states
    if method.machine == "firing" and solution.patches.scene.lights.openings is not None:
        own = Problem.of(solution.patches, through=True)
    algorithm = make(geometry, own, method, seed, solution.replicates)
    state = algorithm.read(solution.state, algorithm.sizes)
    found = []
    for group in range(problem.groups.n_groups):
        power, scale = algorithm.tally.irradiance(own, state, group)
        others = [algorithm.tally.moment(own, state, group, k) for k in range(1, algorithm.tally.basis.size)]
        for one in (power, *others):
            received = np.asarray(one, np.float64) * (scale / unit[group]) / problem.patches.area
            found.append(problem.groups.scatter.of_rows(received, group))
    return np.stack(found, axis=-1)


def mean_reflected(solution: Solution, problem: Problem) -> np.ndarray:
    """Return B - E of the solution, (n_patches, n_groups * K) float64, in shares of `Problem.unit`; see `reflected`."""
    unit, leaders = np.maximum(problem.unit, 1e-300), problem.groups.leaders
    means = problem.groups.scatter.of(solution.irradiance[:, leaders]) / unit
    if solution.irradiance_coefficients is None:
        return means
    others = problem.groups.scatter.of_moments(solution.irradiance_coefficients[:, leaders]) / unit[:, None]
    return np.concatenate([means[:, :, None], others], axis=2).reshape(len(means), -1)
