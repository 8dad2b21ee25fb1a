"""Smoothed values: levels of a binomial filter over a lattice of patches, chosen by the bias and the variance that replicates show.

Each pass replaces a value by half of it and a quarter of the two that are as far away on both sides, along each axis of the lattice:
1, 2 and 4 patches away in turn (M. Holschneider et al., "A real-time algorithm for signal analysis with the help of the wavelet
transform", in Wavelets, 1989). So linear fields stay as they are, up to the rim, and no value that is positive becomes negative.

The bias of a level is the sum of what its passes change in the mean. The square of a change, less its variance, estimates the
squared change without bias. The estimate of a single patch is noisy, so it is averaged over two windows, and the larger one is taken:
a narrow window sees the edge of a shadow, a wide one sees what is small. Each patch takes the level of the least squared bias and
variance. At edges that is the level 0, the value as it was.
"""

import numpy as np

from ..patches.model import Patches
from .lattice import Lattice, Pairs

LEVELS = 3  # passes
NARROW = 2  # passes of the narrow window; the wide one has all
HELD = 0.5  # share of a sheet's sum that smoothed values must hold at least, for the sum to be restored
LEAST_REPLICATES = 2


def smoothed(patches: Patches, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return smoothed values, (replicates, n_patches), and the size of the bias of their mean, (n_patches,).

    In each replicate the sum over each sheet (the congruent patches of one plane, side and surface) stays as it was.

    Args:
        values: (replicates, n_patches) irradiance, 2 replicates at least.
    """
    lattice = Lattice.of(patches)
    steps = lattice.pairs(LEVELS)
    levels = [np.ascontiguousarray(values.T, np.float64)]
    for pairs in steps:
        levels.append(_passed(levels[-1], pairs))
    variance, bias = _told(levels, steps)
    level = (variance + bias**2).argmin(axis=1)
    result = levels[0].copy()
    for number, one in enumerate(levels):
        np.copyto(result, one, where=(level == number)[:, None])
    return _with_sums(result.T, values, lattice.sheet, level > 0), bias[np.arange(len(level)), level]


def _passed(values: np.ndarray, pairs: Pairs) -> np.ndarray:
    """Return values, (n_patches, k), after a pass along each axis."""
    for back, forth in pairs:
        around = values.take(back, axis=0)
        around += values.take(forth, axis=0)
        around /= 2
        around += values
        around /= 2
        values = around
    return values


def _told(levels: list[np.ndarray], steps: list[Pairs]) -> tuple[np.ndarray, np.ndarray]:
    """Return the variance of the mean and the size of its bias at each level, (n_patches, levels) each, averaged over windows.

    Args:
        levels: values of each level, (n_patches, replicates).
        steps: the pairs of each pass.
    """
    count = len(levels)
    estimates = [_mean_and_variance(one)[1] for one in levels]
    for before, after in zip(levels, levels[1:], strict=False):
        mean, variance = _mean_and_variance(after - before)
        estimates.append(mean**2 - variance)
    windows = [np.stack(estimates, axis=1)]
    for pairs in steps:
        windows.append(_passed(windows[-1], pairs))
    changes = np.maximum(np.maximum(windows[NARROW], windows[-1])[:, count:], 0)
    bias = np.zeros((len(changes), count))
    np.cumsum(np.sqrt(changes), axis=1, out=bias[:, 1:])
    return windows[-1][:, :count], bias


def _mean_and_variance(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean over replicates and its variance, (n_patches,) each."""
    replicates = values.shape[1]
    mean = values.sum(axis=1) / replicates
    rest = values - mean[:, None]
    return mean, np.einsum("ij,ij->i", rest, rest) / (replicates * (replicates - 1))


def _with_sums(result: np.ndarray, values: np.ndarray, sheet: np.ndarray, changed: np.ndarray) -> np.ndarray:
    """Return smoothed values, scaled where they changed so that each sheet keeps its sum in each replicate."""
    scaled = np.array(values, np.float64)
    some = sheet[changed]
    for row, after in zip(scaled, result, strict=True):
        after = after[changed]
        held, landed = (np.bincount(some, one, sheet.max() + 1) for one in (after, row[changed]))
        usable = held > HELD * np.abs(landed)
        row[changed] = after * np.where(usable, landed / np.where(usable, held, 1), 1)[some]
    return scaled
