"""Intervals that hold the true value with a stated probability (contract 5).

Replicates are independent. Where enough lines hit for the mean of one replicate to be near normal, (mean - truth) over standard
error follows Student's distribution with one degree of freedom less than there are replicates. Where few lines hit, only their
number is known. It bounds from above what the patch receives, as a count of a Poisson distribution (F. Garwood, "Fiducial limits
for the Poisson distribution", Biometrika 28, 1936). Where hit counts vary more than those of Poisson, it counts clusters of
lines: all patches share one sequence, so at few lines a patch hits come in clusters.
"""

from dataclasses import dataclass

import numpy as np

from ..errors import MethodError
from ..pieces import pieces
from ..scene.back import Back

FEW = 30  # hits, all replicates together: Student's intervals of patches with fewer are too narrow (docs/errors.md)
ROUNDING = 1e-13  # relative rounding error of sums over replicates
MOST_TOGETHER = 1e18  # lines; more are traced by no run
QUANTITIES = ("radiosity", "irradiance")


def student(level: float, replicates: int) -> float:
    """Half the width of a two-sided interval, in standard errors; NaN for a single replicate.

    Raises:
        MethodError: a level that is no number in (0, 1).
    """
    if not isinstance(level, int | float | np.number) or not 0 < level < 1:
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
    each, place = np.unique(groups, return_inverse=True)  # a limit takes microseconds, and few counts differ
    place = place.reshape(groups.shape)
    low = np.where(each > 0, gammaincinv(np.maximum(each, 1e-9), 1 - level), 0.0)
    return cluster * low[place], cluster * gammaincinv(each + 1, level)[place]


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


@dataclass(frozen=True, eq=False)
class Whole:
    """What intervals of patches take from their whole solution.

    Attributes:
        usual: (n_bands,) W or lm, the power that a line brings to any patch, see `usual_power`.
        line: (n_bands,) W or lm, the same, and at least that of a line from the lights.
        together: (n_bands,) lines that come together, see `cluster`.
    """

    usual: np.ndarray
    line: np.ndarray
    together: np.ndarray

    @staticmethod
    def of(solution) -> "Whole":
        """Find it: one pass over all patches."""
        patches, mean, arrivals = solution.patches.solid, solution.irradiance, solution.arrivals
        line = power_of_a_line(patches.emission, patches.area, solution.quanta * solution.replicates)
        usual = usual_power(mean, arrivals, patches.area)
        together = cluster(mean, solution.irradiance_standard_error, arrivals, patches.area)
        return Whole(usual, np.maximum(usual, line), together)


def few_of(solution, rows: np.ndarray | slice = slice(None)) -> np.ndarray:
    """Return the values of `Solution.few` of all patches or of some of them, (m,) bool."""
    patches = solution.patches
    passed = patches.scene.back[patches.face[rows]] == Back.OPEN
    return (solution.arrivals[rows] < FEW) & ~passed & (not solution.by_baseline)


def of_patches(
    solution, level: float, quantity: str, rows: np.ndarray | slice = slice(None), whole: Whole | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """The intervals of `Solution.interval`, of all patches or of some of them.

    Args:
        rows: numbers of the patches.
        whole: of the solution, where it is known already.
    """
    check(quantity)
    ends = _received(solution, level, rows, whole)
    if quantity == "irradiance":
        return ends
    emission, scatter = solution.patches.emission[rows], solution.patches.scatter
    beyond = ends if scatter.other is None else _received(solution, level, scatter.other[rows], whole)
    low, high = (emission + scatter.error_of(*both, rows) for both in zip(ends, beyond, strict=True))
    return low, high


def _received(solution, level: float, rows: np.ndarray | slice, whole: Whole | None) -> tuple[np.ndarray, np.ndarray]:
    """The intervals of the irradiance of some patches."""
    mean, error, area = (x[rows] for x in (solution.irradiance, solution.irradiance_standard_error, solution.patches.solid.area))
    # form factors that agree tell nothing about their error
    shown = np.where(error > 0, error, np.nan) if solution.by_baseline else error
    half = student(level, solution.replicates) * shown
    low, high = np.maximum(mean - half, 0), mean + half
    few = few_of(solution, rows)[:, None] | (mean == 0)
    if few.any() and not solution.by_baseline:
        whole = solution.of_whole if whole is None else whole
        usual = np.where(mean == 0, _power_of_none(error, area, whole.line), whole.usual)
        bounds = irradiance_bounds(mean, solution.arrivals[rows], area, 0.5 + level / 2, whole.together, usual)
        low, high = widened(low, high, few, *bounds, mean if solution.signed else None)
    return low, high


def power_of_none(solution, part: slice, line: np.ndarray) -> np.ndarray:
    """The power that a line would have brought to those patches of a slice that received nothing, (m, n_bands) W or lm.

    Their standard error is made of it. Files of older versions have a zero there: then it is the power of a usual line, or of
    a line from the lights. Entries of other patches mean nothing.

    Args:
        line: as in `Whole`.
    """
    return _power_of_none(solution.irradiance_standard_error[part], solution.patches.solid.area[part], line)


def _power_of_none(error: np.ndarray, area: np.ndarray, line: np.ndarray) -> np.ndarray:
    one = error * area[:, None]
    return np.where(one > 0, one, line)


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
