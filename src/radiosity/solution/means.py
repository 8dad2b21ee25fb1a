"""Intervals of area means over surfaces and over the scene.

Each replicate has its own mean over a set of patches, so what patches of a replicate have in common does not narrow the interval.
Where few lines landed on a set, it goes to the bounds from their number, as intervals of patches do.
"""

import numpy as np

from .errors import mean_and_error
from .intervals import FEW, check, cluster, irradiance_bounds, least_error, power_of_none, student, usual_power, widened


def of_surfaces(solution, level: float, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """See `Solution.surface_interval`."""
    return _of_sets(solution, level, quantity, np.arange(len(solution.patches.scene.names)))


def of_scene(solution, level: float, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """See `Solution.scene_interval`."""
    low, high = _of_sets(solution, level, quantity, np.zeros(len(solution.patches.scene.names), np.int64))
    return low[0], high[0]


def _of_sets(solution, level: float, quantity: str, key: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(k, n_bands) each: intervals of area means over k sets of surfaces, NaN where unknown.

    Args:
        key: (n_surfaces,) int, the set of each surface, 0 to k - 1.
    """
    check(quantity)
    patches, n = solution.patches, int(key.max()) + 1
    here, shape = key[patches.surface], (n, patches.emission.shape[1])
    area = np.bincount(here, patches.area, n)
    area = np.where(area > 0, area, np.nan)  # no patches, no mean
    if solution.surface_power is None:
        return np.full(shape, np.nan), np.full(shape, np.nan)
    power = np.zeros((*solution.surface_power.shape[:2], *shape))
    np.add.at(np.moveaxis(power, 2, 0), key, np.moveaxis(solution.surface_power, 2, 0))
    received, reflected = power / area[:, None]  # (replicates, k, n_bands)
    mean, error = mean_and_error(received if quantity == "irradiance" else reflected)
    half = student(level, solution.replicates)
    if solution.by_baseline:
        error = np.where(error > 0, error, np.nan)  # factors that agree say nothing of their error
        low, high = np.maximum(mean - half * error, 0), mean + half * error
    else:
        usual, share, arrivals = _usual(solution, here, shape), 1.0, np.bincount(here, solution.arrivals, n)
        got, its_error = mean_and_error(received)
        bunches = np.maximum(cluster(got, its_error, arrivals, area), _cluster(solution))
        if quantity == "radiosity":
            share = np.zeros(shape)
            np.maximum.at(share, here, patches.reflectance)
        error = least_error(mean, error, arrivals, area, usual * share, solution.replicates)
        low, high = np.maximum(mean - half * error, 0), mean + half * error
        least, most = irradiance_bounds(got, arrivals, area, 0.5 + level / 2, bunches, usual)
        least = least if quantity == "irradiance" else 0 * least  # where reflectances differ, lines may land on the darkest
        few = (arrivals < FEW)[:, None] | (got == 0)
        low, high = widened(low, high, few, least, most * share, mean if solution.signed else None)
    if quantity == "radiosity":
        emitted = np.stack([np.bincount(here, patches.area * band, n) for band in patches.emission.T], axis=1) / area[:, None]
        low, high = low + emitted, high + emitted
    return low, high


def _usual(solution, here: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """(k, n_bands) W or lm that a line brings to a set which none reached: the usual power, or the most that one would have
    brought to its patches that received nothing."""
    mean, area = solution.irradiance, solution.patches.area
    one = np.tile(usual_power(mean, solution.arrivals, area), (shape[0], 1))
    np.maximum.at(one, here, np.where(mean == 0, power_of_none(solution), 0))
    return one


def _cluster(solution) -> np.ndarray:
    """(n_bands,) of patches, which come in larger numbers than sets."""
    return cluster(solution.irradiance, solution.irradiance_standard_error, solution.arrivals, solution.patches.area)
