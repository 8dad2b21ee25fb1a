"""The table of methods that the table tests run, and how their replicates are compared with references.

A new preset is in the table by itself; a combination of choices that no preset makes is one line here.
"""

import numpy as np
from scipy import stats

import radiosity as rd
from radiosity.engine.device import choose
from radiosity.engine.geometry import Geometry
from radiosity.engine.problem import Problem
from radiosity.engine.process import make

COMBINATIONS = {
    "continuous, sobol": rd.Method(equation="continuous", numbers="sobol"),
    "continuous, depth-first, random": rd.Method(equation="continuous", order="depth-first", numbers="random"),
    "continuous, staged": rd.Method(equation="continuous", order="staged"),
    "discrete, drawn": rd.Method(absorption="drawn"),
    "discrete, absorption": rd.Method(estimator="absorption"),
    "discrete, survival": rd.Method(estimator="survival"),
    "discrete, gathering": rd.Method(estimator="gathering"),
    "discrete, fractional": rd.Method(absorption="fractional"),
    "continuous, absorption": rd.Method(equation="continuous", estimator="absorption"),
    "continuous, survival": rd.Method(equation="continuous", estimator="survival"),
    "continuous, gathering": rd.Method(equation="continuous", estimator="gathering"),
    "depth-first": rd.Method(order="depth-first"),
    "incremental, bidirectional": rd.Method(order="incremental", estimator="bidirectional"),
    "multipath, disc": rd.Method(lines="global-disc", order="multipath"),
    "multipath, spans, first shot": rd.Method(lines="spans", order="multipath", first_shot=0.3),
    "pooled, global": rd.Method(lines="global", order="regular"),
    "pooled, spans, first shot": rd.Method(lines="spans", order="regular", first_shot=0.3),
    "matrix, local": rd.Method(order="matrix"),
    "matrix, spans": rd.Method(lines="spans", order="matrix"),
    "matrix, bundles": rd.Method(lines="bundles", order="matrix"),
}
METHODS = {name: preset.method for name, preset in rd.PRESETS.items()} | COMBINATIONS

ALPHA = 1e-4  # of all comparisons of one test together (Bonferroni)


def surface_powers(solution: rd.Solution) -> np.ndarray:
    """(replicates, n_surfaces) power that arrives on each surface in the first group of bands, W."""
    problem = Problem.of(solution.patches)
    method = rd.Method(**solution.provenance["choices"])
    tally = make(Geometry(solution.patches, choose("cpu")), problem, method, 0, 1).tally
    values, unit = tally.irradiance(problem, solution.state, 0)
    surface = solution.patches.surface
    return np.stack([values[:, surface == s].sum(axis=1) for s in np.unique(surface)], axis=1) * unit


def differences(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Of the means of (replicates, k) values, in combined standard errors (or, of values without spread, 1e-6 of them)."""
    errors = [np.maximum(x.std(axis=0, ddof=1) / len(x) ** 0.5, 1e-6 * np.abs(x.mean(axis=0))) for x in (one, other)]
    return (one.mean(axis=0) - other.mean(axis=0)) / np.hypot(*errors)


def critical(replicates: int, comparisons: int) -> float:
    """Student's bound for the largest of so many differences at `ALPHA`."""
    return float(stats.t.ppf(1 - ALPHA / comparisons / 2, replicates - 1))
