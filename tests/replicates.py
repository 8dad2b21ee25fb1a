"""What the replicates of a solution say, surface by surface, for the tests."""

import numpy as np

import radiosity as rd
from radiosity.algorithms.base import AbstractAlgorithm, AbstractTally
from radiosity.algorithms.table import make
from radiosity.device.backend import choose
from radiosity.problem.model import Problem
from radiosity.tracing.geometry import Geometry


def powers(solution: rd.Solution, *, key=None, tally: AbstractTally | None = None, group: int = 0) -> np.ndarray:
    """(replicates, k) power that arrives, W, summed over patches of an equal key, in the
    order of keys: the surface, unless another is given."""
    patches, problem = solution.patches, Problem.of(solution.patches)
    algorithm = process_of(solution, problem)
    state = algorithm.read(solution.state, algorithm.sizes)
    values, unit = (algorithm.tally if tally is None else tally).irradiance(problem, state, group)
    _, key = np.unique(patches.surface if key is None else key, return_inverse=True)
    return np.stack([np.bincount(key, row) for row in np.asarray(values, float)]) * unit


def process_of(solution: rd.Solution, problem: Problem) -> AbstractAlgorithm:
    """A new one of the solution's method."""
    method, seed = rd.Method(**solution.provenance["choices"]), solution.provenance["seed"]
    return make(Geometry(solution.patches, choose("cpu")), problem, method, seed, solution.replicates)


def difference(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Of the means of (replicates, k) values, in combined standard errors (or, of values without spread, 1e-6 of them)."""
    errors = [np.maximum(x.std(axis=0, ddof=1) / len(x) ** 0.5, 1e-6 * np.abs(x.mean(axis=0))) for x in (one, other)]
    return (one.mean(axis=0) - other.mean(axis=0)) / np.maximum(np.hypot(*errors), 1e-300)
