"""Intervals that hold the true value with a stated probability (contract 5).

Replicates are independent, so (mean - truth) / standard error follows Student's distribution with one degree of freedom less than
there are replicates, where enough lines landed for the mean of one replicate to be near normal. Where few did, their number is
what is known: as that of Poisson's lines, or of clusters of lines where arrivals vary more than Poisson's (all patches share one
sequence, so at few lines a patch they come in clusters), it bounds what the patch receives from above (F. Garwood, "Fiducial
limits for the Poisson distribution", Biometrika 28, 1936).
"""

import numpy as np

from ..errors import MethodError
from ..pieces import pieces
from .errors import mean_and_error

FEW = 30  # arrivals, all replicates together: Student's intervals of patches with fewer are too narrow (docs/errors.md)
QUANTITIES = ("radiosity", "irradiance")


def student(level: float, replicates: int) -> float:
    """Half the width of a two-sided interval, in standard errors; NaN of a single replicate.

    Raises:
        MethodError: a level outside (0, 1).
    """
    if not 0 < level < 1:
        raise MethodError(f"level is {level!r}; it must lie between 0 and 1, such as 0.95")
    if replicates < 2:
        return float("nan")
    from scipy.stats import t

    return float(t.ppf(0.5 + level / 2, replicates - 1))


def power_of_an_arrival(irradiance: np.ndarray, arrivals: np.ndarray, area: np.ndarray, usual=None) -> np.ndarray:
    """(n_patches, n_bands) W or lm that a line brings to a patch, in the mean of replicates: of its own lines, or of the scene's
    where none landed.

    Args:
        irradiance: (n_patches, n_bands). arrivals: (n_patches,), replicates together. area: (n_patches,) m².
        usual: `usual_power` of the scene that the patches are some of. Default: they are all.
    """
    usual = usual_power(irradiance, arrivals, area) if usual is None else usual
    power, count = irradiance * area[:, None], arrivals[:, None]
    own = np.divide(power, count, out=np.zeros_like(power), where=count > 0)
    return np.where(own > 0, own, usual)


def usual_power(irradiance: np.ndarray, arrivals: np.ndarray, area: np.ndarray) -> np.ndarray:
    """(n_bands,) W or lm that a line brings to any patch."""
    total = np.zeros(irradiance.shape[1])
    for part in pieces(len(area)):
        total += (irradiance[part] * area[part, None]).sum(axis=0)
    return total / max(int(arrivals.sum()), 1)


def cluster(irradiance: np.ndarray, error: np.ndarray, arrivals: np.ndarray, area: np.ndarray) -> np.ndarray:
    """(n_bands,) lines that come together: the variance of arrivals over their number, on patches that few reached; 1 at
    least."""
    here = (arrivals > 0) & (arrivals < FEW)
    if not here.any():
        return np.ones(irradiance.shape[1])
    usual = usual_power(irradiance, arrivals, area)
    one = power_of_an_arrival(irradiance[here], arrivals[here], area[here], usual)
    relative = np.divide(error[here] * area[here, None], one, out=np.zeros_like(one), where=one > 0)
    return np.maximum((relative**2).sum(axis=0) / arrivals[here].sum(), 1)


def irradiance_bound(
    irradiance: np.ndarray, arrivals: np.ndarray, area: np.ndarray, level: float, cluster: np.ndarray | float = 1.0
) -> np.ndarray:
    """(n_patches, n_bands) what the irradiance does not exceed, with a probability of ``level``, by the distribution of
    arrivals alone: rough where many landed, and all that is known where none did. Arguments as of `power_of_an_arrival`."""
    from scipy.stats import chi2

    most = cluster * chi2.ppf(level, 2 * (arrivals[:, None] / cluster + 1)) / 2
    return most * power_of_an_arrival(irradiance, arrivals, area) / area[:, None]


def least_error(irradiance: np.ndarray, error: np.ndarray, arrivals: np.ndarray, area: np.ndarray) -> np.ndarray:
    """(n_patches, n_bands) standard error, where it is zero since few lines landed and all replicates agree by chance: that of
    Poisson's arrivals, and of one arrival where there was none. It is written over."""
    usual = usual_power(irradiance, arrivals, area)
    for part in pieces(len(area)):
        count, lucky = arrivals[part], (error[part] == 0) & (arrivals[part] < FEW)[:, None]
        if not lucky.any():
            continue
        spread = power_of_an_arrival(irradiance[part], count, area[part], usual)
        spread *= (np.sqrt(np.maximum(count, 1)) / area[part])[:, None]
        np.copyto(error[part], spread, where=lucky)
    return error


def of_patches(solution, level: float, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """See `Solution.interval`."""
    _known(quantity)
    mean, few = solution.irradiance, solution.few
    half = student(level, solution.replicates) * solution.irradiance_standard_error
    low, high = np.maximum(mean - half, 0), mean + half
    counted = (mean, solution.arrivals, solution.patches.area)
    together = cluster(mean, solution.irradiance_standard_error, *counted[1:])
    bound = irradiance_bound(*counted, 0.5 + level / 2, together)
    high = np.where(few[:, None], np.maximum(high, bound), high)  # NaN stays
    if quantity == "irradiance":
        return low, high
    emission, rho = solution.patches.emission, solution.patches.reflectance
    return tuple(np.where(rho == 0, emission, emission + rho * end) for end in (low, high))


def of_surfaces(solution, level: float, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """See `Solution.surface_interval`."""
    return _of_means(solution, level, quantity, lambda power: power)


def of_scene(solution, level: float, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """See `Solution.scene_interval`."""
    low, high = _of_means(solution, level, quantity, lambda power: power.sum(axis=-2, keepdims=True))
    return low[0], high[0]


def _of_means(solution, level: float, quantity: str, together) -> tuple[np.ndarray, np.ndarray]:
    """(k, n_bands) each: intervals of area means over k sets of surfaces, NaN where unknown.

    Each replicate has its own mean over a set, so what patches have in common does not narrow the interval.

    Args:
        together: sums (..., n_surfaces, n_bands) over the surfaces of each set, to (..., k, n_bands).
    """
    _known(quantity)
    patches, n = solution.patches, len(solution.patches.scene.names)
    area = together(np.bincount(patches.surface, patches.area, n)[:, None])
    area = np.where(area > 0, area, np.nan)  # no patches, no mean
    if solution.surface_power is None:
        unknown = np.full((len(area), patches.emission.shape[1]), np.nan)
        return unknown, unknown
    received, reflected = together(solution.surface_power) / area  # (replicates, k, n_bands)
    mean, error = mean_and_error(received if quantity == "irradiance" else reflected)
    half = student(level, solution.replicates) * error
    low, high = np.maximum(mean - half, 0), mean + half
    if quantity == "radiosity":
        emitted = [np.bincount(patches.surface, patches.area * band, n) for band in patches.emission.T]
        emitted = together(np.stack(emitted, axis=1)) / area
        low, high = low + emitted, high + emitted
    return low, high


def _known(quantity: str) -> None:
    if quantity not in QUANTITIES:
        raise MethodError(f"quantity '{quantity}' has no interval; known are {', '.join(QUANTITIES)}")
