"""Intervals of area means over surfaces and over the scene.

Each replicate has its own mean over a set of patches, so errors that patches of a replicate have in common do not narrow the
interval. Where few lines hit a set, the interval goes to the bounds from their number, as intervals of patches do.
"""

from dataclasses import dataclass

import numpy as np

from ..pieces import pieces
from .errors import mean_and_error
from .intervals import FEW, check, cluster, irradiance_bounds, least_error, power_of_none, student, usual_power, widened
from .sides import BACK


def of_surfaces(solution, level: float, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """The intervals of `Solution.surface_interval`."""
    n, surface = len(solution.patches.scene.names), solution.patches.surface
    bias = None if solution.side_bias is None else solution.side_bias[0::2] + solution.side_bias[1::2]
    ends = _of_sets(solution, level, quantity, np.where(solution.sides.left_out, -1, surface), n, solution.surface_power, bias)
    return ends.low, ends.high


def of_scene(solution, level: float, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """The interval of `Solution.scene_interval`."""
    power = solution.surface_power
    if power is not None:
        whole = np.zeros((*power.shape[:2], 1, power.shape[3]))
        np.add.at(np.moveaxis(whole, 2, 0), np.zeros(power.shape[2], np.int64), np.moveaxis(power, 2, 0))
        power = whole
    bias = None if solution.side_bias is None else solution.side_bias.sum(axis=0, keepdims=True)
    ends = _of_sets(solution, level, quantity, np.where(solution.sides.left_out, -1, 0), 1, power, bias)
    return ends.low[0], ends.high[0]


def of_rows(solution, level: float, quantity: str) -> "Ends":
    """The errors and intervals of the rows of tables (`Solution.sides`); ``quantity`` may also be "absorbed"."""
    sides, bias = solution.sides, solution.side_bias
    if bias is not None:
        front, back = bias[2 * sides.surface], bias[2 * sides.surface + 1]
        part = np.array([side == BACK for side in sides.side])[:, None]
        bias = np.where(sides.whole[:, None], front + back, np.where(part, back, front))
    return _of_sets(solution, level, quantity, sides.row, len(sides.surface), row_powers(solution), bias)


def row_powers(solution) -> np.ndarray | None:
    """What the rows of tables receive and reflect in each replicate, (2, replicates, n_rows, n_bands) W or lm.

    NaN where a file holds no powers of sides, and None where it holds no powers.
    """
    sides, power = solution.sides, solution.surface_power
    if power is None:
        return None
    power = power[:, :, sides.surface]
    back = np.array([side == BACK for side in sides.side])
    parts = ~sides.whole
    of_sides = solution.side_power
    power[:, :, parts] = np.nan if of_sides is None else of_sides[:, :, (2 * sides.surface + back)[parts]]
    return power


@dataclass(frozen=True, eq=False)
class Ends:
    """Standard error and interval of area means over k sets, (k, n_bands) each; NaN where unknown."""

    error: np.ndarray
    low: np.ndarray
    high: np.ndarray


def _of_sets(
    solution, level: float, quantity: str, key: np.ndarray, n: int, power: np.ndarray | None, bias: np.ndarray | None
) -> Ends:
    """Intervals of area means over sets of patches, NaN where unknown.

    Args:
        quantity: one of `intervals.QUANTITIES`, or "absorbed": irradiance less its reflected part.
        key: (n_patches,) int, the set of each patch, 0 to n - 1, or -1 for patches in no set.
        n: the number of sets.
        power: (2, replicates, n, n_bands) W or lm that the sets receive, and the part that they reflect.
        bias: (n, n_bands) W or lm, by how much what they receive may be off in all replicates alike; None: by nothing.
    """
    if quantity != "absorbed":
        check(quantity)
    patches, some = solution.patches.solid, key >= 0
    here, shape = key[some], (n, patches.emission.shape[1])
    its_area, scatter = patches.area[some], patches.scatter
    area = np.bincount(here, its_area, n)
    area = np.where(area > 0, area, np.nan)  # a set without patches has no mean
    if power is None:
        return Ends(*(np.full(shape, np.nan) for _ in range(3)))
    received, reflected = power / area[:, None]  # (replicates, n, n_bands)
    values = {"irradiance": received, "radiosity": reflected}.get(quantity, received - reflected)
    mean, error = mean_and_error(values)
    if bias is not None:
        part, whole = np.abs(mean), received.mean(axis=0)
        part = np.divide(part, whole, out=np.ones_like(part), where=whole > 0)  # of what is received
        error = np.hypot(error, part * bias / area[:, None])
    half = student(level, solution.replicates)
    # a side of a diffusing pane may send out more than it receives: that counts as negative absorption
    floor = -np.inf if quantity == "absorbed" and scatter.through is not None else 0.0
    if solution.by_baseline:
        error = np.where(error > 0, error, np.nan)  # form factors that agree tell nothing about their error
        low, high = np.maximum(mean - half * error, floor), mean + half * error
    else:
        usual, share = _usual(solution, key, shape), np.ones(shape)
        arrivals = np.bincount(here, solution.arrivals[some], n)
        got, its_error = mean_and_error(received)
        bunches = np.maximum(cluster(got, its_error, arrivals, area), _cluster(solution))
        if quantity != "irradiance":
            share = np.zeros(shape)
            for part in pieces(len(key)):
                among, values = key[part] >= 0, scatter.reflectance[part]
                np.maximum.at(share, key[part][among], (values if quantity == "radiosity" else 1 - values)[among])
        error = least_error(mean, error, arrivals, area, usual * share, solution.replicates)
        low, high = np.maximum(mean - half * error, floor), mean + half * error
        least, most = irradiance_bounds(got, arrivals, area, 0.5 + level / 2, bunches, usual)
        least = least if quantity == "irradiance" else 0 * least  # where reflectances differ, lines may hit the darkest
        few, most = (arrivals < FEW)[:, None] | (got == 0), most * share
        if quantity != "irradiance" and scatter.through is not None:
            beyond, unsure = _from_beyond(solution, scatter, some, here, area, level, bunches, usual)
            few, most = few | unsure, most + (beyond if quantity == "radiosity" else 0)
            least = least - (beyond if quantity == "absorbed" else 0)
        low, high = widened(low, high, few, least, most, mean if solution.signed else None)
    if quantity != "irradiance" and patches.pane_of is not None:  # what leaves or heats the solid part, over the whole area
        whole = np.bincount(here, patches.whole.area[some], n)
        part = np.divide(area, whole, out=np.ones(n), where=whole > 0)[:, None]
        error, low, high = error * part, low * part, high * part
        area = area / part[:, 0]
    if quantity == "radiosity":
        emission = patches.emission[some]
        emitted = np.stack([np.bincount(here, its_area * band, n) for band in emission.T], axis=1) / area[:, None]
        low, high = low + emitted, high + emitted
    return Ends(error, low, high)


def _from_beyond(solution, scatter, some, here, area, level: float, bunches, usual) -> tuple[np.ndarray, np.ndarray]:
    """Return a bound of what sets send on of the light on the other side, (k, n_bands), and where few lines hit there."""
    n, other = len(area), scatter.other[some]
    its_area = solution.patches.solid.area[some]
    arrivals = np.bincount(here, solution.arrivals[other], n)
    light = np.stack([np.bincount(here, its_area * band, n) for band in solution.irradiance[other].T], axis=1) / area[:, None]
    share = np.zeros(light.shape)
    np.maximum.at(share, here, scatter.through[some])
    _, most = irradiance_bounds(light, arrivals, area, 0.5 + level / 2, bunches, usual)
    return most * share, (share > 0) & ((arrivals < FEW)[:, None] | (light == 0))


def _usual(solution, key: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """The power that a line brings to a set that no line reached, (k, n_bands) W or lm.

    It is the usual power, or the most that a line would have brought to its patches that received nothing.
    """
    mean, area = solution.irradiance, solution.patches.solid.area
    one = np.tile(usual_power(mean, solution.arrivals, area), (shape[0], 1))
    line = solution.of_whole.line
    for part in pieces(len(key)):
        some = key[part] >= 0
        power = np.where(mean[part] == 0, power_of_none(solution, part, line), 0)
        np.maximum.at(one, key[part][some], power[some])
    return one


def _cluster(solution) -> np.ndarray:
    """The `cluster` of patches, which are more numerous than sets, (n_bands,)."""
    return cluster(solution.irradiance, solution.irradiance_standard_error, solution.arrivals, solution.patches.solid.area)
