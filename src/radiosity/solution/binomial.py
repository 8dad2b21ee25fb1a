"""Smoothed values: levels of a binomial filter on a lattice of patches, mixed by the bias and the variance that replicates show.

Each pass replaces a value by half of it and a quarter of the two that are as far away on both sides, along each axis of the
lattice: 1, 2 and 4 patches away in turn. So linear fields stay as they are, up to the rim (M. Holschneider, R.
Kronland-Martinet, J. Morlet and P. Tchamitchian, "A real-time algorithm for signal analysis with the help of the wavelet
transform", in "Wavelets", 1989).

What a pass changes in the mean of all replicates is bias b and noise of variance v. The share b² / (b² + v) of the change is
undone, which has the least error (the Wiener filter). The squared change, less v as the replicates show it, estimates b² without
bias. The estimate of a single patch is noisy, so b² and v are averaged over a window about the patch. At the edge of a shadow b
is large, and nearly all is undone. A pass is undone by as much at least as those before it, so that no weight is negative.
"""

from itertools import pairwise

import numpy as np

from ..patches.model import Patches
from .lattice import Lattice, Pairs

PASSES = 3  # of the filter, and of the window
NARROW = 2  # passes of a window of about 32 patches, which sees biases that the whole one thins out
CLEAR = 0.5  # of a variance v: twice the standard error of a mean of 32 squares, 2 sqrt(2 / 32)
HELD = 0.5  # share of a sheet's sum that the smoothed values must hold at least for the sum to be restored
LEAST_REPLICATES = 2


def smoothed(patches: Patches, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return smoothed values, (replicates, n_patches), and the size of the bias of their mean, (n_patches,).

    In each replicate the sum over each sheet (the congruent patches of one plane, side and surface) stays as it was. Where no
    value is negative, no smoothed value is.

    Args:
        values: (replicates, n_patches) irradiance, of `LEAST_REPLICATES` at least: a single one shows no variance.
    """
    lattice = Lattice.of(patches)
    steps = lattice.pairs(PASSES)
    levels = [np.ascontiguousarray(values.T, np.float64)]
    for pairs in steps:
        levels.append(_passed(levels[-1], pairs))
    undone, size = _told(levels, steps)
    parts = np.diff(undone, prepend=0, append=1)
    result = np.zeros_like(levels[0])
    for level, part in zip(levels, parts.T, strict=True):
        result += level * part[:, None]
    return _with_sums(result.T, values, lattice.sheet, undone[:, 0] < 1), ((1 - undone) * size).sum(axis=1)


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
    """Return the share of each pass that is undone, and the size of the bias of the pass, (n_patches, passes) each.

    Args:
        levels: values before the first pass and after each, (n_patches, replicates).
        steps: the pairs of each pass.
    """
    told = [_mean_and_variance(after - before) for before, after in pairwise(levels)]
    windows = [np.stack([mean**2 - variance for mean, variance in told] + [variance for _, variance in told], axis=1)]
    for pairs in steps:
        windows.append(_passed(windows[-1], pairs))
    square, variance = (np.maximum(part, 0) for part in np.split(windows[-1], 2, axis=1))
    near, its_variance = np.split(windows[NARROW], 2, axis=1)
    whole = square + variance
    undone = np.where(whole > 0, square / np.where(whole > 0, whole, 1), 1)
    return np.maximum.accumulate(undone, axis=1), np.sqrt(np.maximum(square, near - CLEAR * its_variance))


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
