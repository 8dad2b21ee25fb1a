"""What the replicates of a solution say, surface by surface, for the tests."""

import numpy as np

import radiosity as rd
from radiosity.algorithms.base import AbstractTally
from radiosity.algorithms.table import make
from radiosity.device.backend import choose
from radiosity.problem.model import Problem
from radiosity.tracing.geometry import Geometry


def powers(solution: rd.Solution, *, key=None, tally: AbstractTally | None = None, group: int = 0) -> np.ndarray:
    """(replicates, k) power that arrives, W, summed over patches of an equal key, in the
    order of keys: the surface, unless another is given."""
    patches, problem = solution.patches, Problem.of(solution.patches)
    if tally is None:
        method = rd.Method(**solution.provenance["choices"])
        tally = make(Geometry(patches, choose("cpu")), problem, method, solution.provenance["seed"], solution.replicates).tally
    values, unit = tally.irradiance(problem, solution.state, group)
    _, key = np.unique(patches.surface if key is None else key, return_inverse=True)
    return np.stack([np.bincount(key, row) for row in np.asarray(values, float)]) * unit


def difference(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Of the means of (replicates, k) values, in combined standard errors (or, of values without spread, 1e-6 of them)."""
    errors = [np.maximum(x.std(axis=0, ddof=1) / len(x) ** 0.5, 1e-6 * np.abs(x.mean(axis=0))) for x in (one, other)]
    return (one.mean(axis=0) - other.mean(axis=0)) / np.maximum(np.hypot(*errors), 1e-300)
