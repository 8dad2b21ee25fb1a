"""Intervals that hold the true value with a stated probability (contract 5).

Replicates are independent. Where enough lines hit for the mean of one replicate to be near normal, (mean - truth) over standard
error follows Student's distribution with one degree of freedom less than there are replicates. Where few lines hit, only their
number is known. It bounds from above what the patch receives, as a count of a Poisson distribution (F. Garwood, "Fiducial limits
for the Poisson distribution", Biometrika 28, 1936). Where hit counts vary more than those of Poisson, it counts clusters of
lines: all patches share one sequence, so at few lines a patch hits come in clusters.
"""

import numpy as np

from ..errors import MethodError
from ..pieces import pieces

FEW = 30  # hits, all replicates together: Student's intervals of patches with fewer are too narrow (docs/errors.md)
ROUNDING = 1e-13  # relative rounding error of sums over replicates
MOST_TOGETHER = 1e18  # lines; more are traced by no run
QUANTITIES = ("radiosity", "irradiance")


def student(level: float, replicates: int) -> float:
    """Half the width of a two-sided interval, in standard errors; NaN for a single replicate.

    Raises:
        MethodError: a level outside (0, 1).
    """
    if not 0 < level < 1:
        raise MethodError(f"level is {level!r}; it must be above 0 and strictly below 1, such as 0.95")
    if replicates < 2:
        return float("nan")
    from scipy.special import stdtrit  # `scipy.stats` has the same, and takes half a second to import

    return float(stdtrit(replicates - 1, 0.5 + level / 2))


def power_of_a_line(emission: np.ndarray, area: np.ndarray, lines: float) -> np.ndarray:
    """The largest power of each of ``lines`` lines from the lights, in the mean of replicates, (n_bands,) W or lm.

    Args:
        emission: (n_patches, n_bands).
        area: (n_patches,) m².
        lines: lines of all replicates together: their number times the quanta of each.
    """
    total, share = 0.0, np.zeros(emission.shape[1])
    for part in pieces(len(area)):
        largest = emission[part].max(axis=1)
        total += float(largest @ area[part])
        share = np.maximum(share, (emission[part] / np.where(largest > 0, largest, 1)[:, None]).max(axis=0))
    return share * (total / max(lines, 1))


def power_of_an_arrival(irradiance: np.ndarray, arrivals: np.ndarray, area: np.ndarray, usual=None) -> np.ndarray:
    """The power that a line brings to a patch, in the mean of replicates, (n_patches, n_bands) W or lm.

    It is that of the patch's own lines, or the usual one where no line brought any.

    Args:
        irradiance: (n_patches, n_bands).
        arrivals: (n_patches,), replicates together.
        area: (n_patches,) m².
        usual: `usual_power` of the scene that the patches belong to. Default: the patches are the whole scene.
    """
    usual = usual_power(irradiance, arrivals, area) if usual is None else usual
    power, count = irradiance * area[:, None], arrivals[:, None]
    own = np.divide(power, count, out=np.zeros_like(power), where=count > 0)
    return np.where(own > 0, own, usual)


def usual_power(irradiance: np.ndarray, arrivals: np.ndarray, area: np.ndarray, line: np.ndarray | float = 0.0) -> np.ndarray:
    """The power that a line brings to any patch, (n_bands,) W or lm.

    It is at least ``line``, the power of a line, (n_bands,) or (n_patches, n_bands), which is known where no line hit. The result
    has the larger shape of both.
    """
    total = np.zeros(irradiance.shape[1])
    for part in pieces(len(area)):
        total += (irradiance[part] * area[part, None]).sum(axis=0)
    return np.maximum(total / max(int(arrivals.sum()), 1), line)


def cluster(irradiance: np.ndarray, error: np.ndarray, arrivals: np.ndarray, area: np.ndarray) -> np.ndarray:
    """The number of lines that come together, at least 1, (n_bands,).

    It is the variance of hits over their number, on patches that few lines hit.
    """
    here = (arrivals > 0) & (arrivals < FEW)
    power, count = irradiance[here] * area[here, None], arrivals[here, None]
    with np.errstate(over="ignore"):  # of powers near zero
        relative = np.divide(error[here] * area[here, None] * count, power, out=np.zeros_like(power), where=power > 0)
        return np.clip((relative**2).sum(axis=0) / max(int(count.sum()), 1), 1, MOST_TOGETHER)


def count_bounds(count: np.ndarray, level: float, cluster: np.ndarray | float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Garwood's lower and upper limit of the mean of a number of hits, each held with a probability of ``level``.

    Without hits they are 0 and -ln(1 - level).
    """
    from scipy.special import gammaincinv

    groups = np.asarray(count / cluster, np.float64)
    low = np.where(groups > 0, gammaincinv(np.maximum(groups, 1e-9), 1 - level), 0.0)
    return cluster * low, cluster * gammaincinv(groups + 1, level)


def irradiance_bounds(
    irradiance: np.ndarray,
    arrivals: np.ndarray,
    area: np.ndarray,
    level: float,
    cluster: np.ndarray | float = 1.0,
    usual: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """A lower and an upper bound of the irradiance, each held with a probability of ``level``, (n_patches, n_bands) each.

    They follow from the distribution of hits alone. They are rough where there are many hits, and all that is known where there
    are no hits. Lines that brought nothing do not count. Arguments are those of `power_of_an_arrival`; ``usual`` may have a row
    for each patch.
    """
    power = power_of_an_arrival(irradiance, arrivals, area, usual) / area[:, None]
    low, high = count_bounds(np.where(irradiance > 0, arrivals[:, None], 0), level, cluster)
    return low * power, high * power


def by_luck(mean: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Return whether all replicates agree, up to rounding, or the powers of lines add up to zero (the residue has signs)."""
    return (error <= ROUNDING * np.abs(mean)) | ((mean == 0) & (error > 0))


def least_error(
    irradiance: np.ndarray,
    error: np.ndarray,
    arrivals: np.ndarray,
    area: np.ndarray,
    usual: np.ndarray | None = None,
    replicates: int = 1,
) -> np.ndarray:
    """The standard error, with a least value where it is zero by chance, (n_patches, n_bands). ``error`` is overwritten.

    It is zero by chance where all replicates agree, or where signed lines of the residue cancel. Where few lines hit, the least
    value is the error of a Poisson count, and that of one hit where no line hit or brought anything. Where many lines hit, it is
    the error of whole numbers: R replicates of equal counts know each of them to a line, uniformly, and their mean to a line
    over sqrt(12 R).

    Args:
        usual: see `usual_power`; (n_bands,) or (n_patches, n_bands).
        replicates: R.
    """
    usual = usual_power(irradiance, arrivals, area) if usual is None else usual
    usual = np.broadcast_to(usual, irradiance.shape)
    for part in pieces(len(area)):
        none = (irradiance[part] == 0) & (arrivals[part, None] == 0)  # signed lines that cancel tell no more than no line
        lucky = by_luck(irradiance[part], error[part]) | none & (error[part] * area[part, None] < usual[part])
        if not lucky.any():
            continue
        count = np.where(irradiance[part] > 0, arrivals[part, None], 0)
        lines = np.where(count < FEW, np.sqrt(np.maximum(count, 1)), np.sqrt(replicates / 12))
        spread = power_of_an_arrival(irradiance[part], arrivals[part], area[part], usual[part]) * lines
        np.copyto(error[part], np.maximum(spread / area[part, None], error[part]), where=lucky)
    return error


def of_patches(solution, level: float, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """The intervals of `Solution.interval`."""
    check(quantity)
    mean, error, area = solution.irradiance, solution.irradiance_standard_error, solution.patches.solid.area
    # form factors that agree tell nothing about their error
    shown = np.where(error > 0, error, np.nan) if solution.by_baseline else error
    half = student(level, solution.replicates) * shown
    low, high = np.maximum(mean - half, 0), mean + half
    few = solution.few[:, None] | (mean == 0)
    if few.any() and not solution.by_baseline:
        usual = np.where(mean == 0, power_of_none(solution), usual_power(mean, solution.arrivals, area))
        together = cluster(mean, error, solution.arrivals, area)
        bounds = irradiance_bounds(mean, solution.arrivals, area, 0.5 + level / 2, together, usual)
        low, high = widened(low, high, few, *bounds, mean if solution.signed else None)
    if quantity == "irradiance":
        return low, high
    emission, scatter = solution.patches.emission, solution.patches.scatter
    return tuple(emission + scatter.error_of(end) for end in (low, high))


def power_of_none(solution) -> np.ndarray:
    """The power that a line would have brought to patches that received nothing, (n_patches, n_bands) W or lm.

    Their standard error is made of it. Files of older versions have a zero there: then it is the power of a usual line, or of
    a line from the lights. Entries of other patches mean nothing.
    """
    patches, mean = solution.patches.solid, solution.irradiance
    one = solution.irradiance_standard_error * patches.area[:, None]
    line = power_of_a_line(patches.emission, patches.area, solution.quanta * solution.replicates)
    return np.where(one > 0, one, usual_power(mean, solution.arrivals, patches.area, line))


def widened(low, high, few, least, most, signed=None) -> tuple[np.ndarray, np.ndarray]:
    """Return intervals that go to ``least`` and ``most`` where few lines hit; NaN stays.

    Where lines take power away as well (the mean is ``signed``), their number bounds the error of the mean on both sides.
    """
    if signed is not None:
        least, most = np.maximum(signed - most, 0), signed + most
    return np.where(few, np.minimum(low, least), low), np.where(few, np.maximum(high, most), high)


def check(quantity: str) -> None:
    """Refuse quantities that have no interval.

    Raises:
        MethodError: no such quantity.
    """
    if quantity not in QUANTITIES:
        raise MethodError(f"quantity '{quantity}' has no interval; known are {', '.join(QUANTITIES)}")
