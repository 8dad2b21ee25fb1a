"""Patches that no line of a replicate measures, and the irradiance that they are given.

Some methods find irradiance as a mean over the lines of a patch, and a patch without lines has no mean. With zero in its place it
would reflect nothing, and the whole scene would come out too dark, with small error bars: half of the light was missing at 0.7
lines a patch. So the patch takes the mean over the lines of its side of its face, or, where there are none, over those of the
scene. The whole of such a value counts as its bias (`AbstractMeanTally.bias`).
"""

import warnings

import numpy as np

from ..errors import RadiosityWarning
from ..patches.model import Patches

TOLD = 0.01  # share of the area above which there is a warning; stated errors hold less often there, too


def sides(patches: Patches) -> np.ndarray:
    """The number of the side of the face that each patch lies on, (n_patches,) int64."""
    return 2 * patches.face.astype(np.int64) + patches.is_back


def means(sums: np.ndarray, lines: np.ndarray, side: np.ndarray) -> np.ndarray:
    """The sums over the lines of each patch, divided by the number of lines, (..., n_patches) float64.

    Where that number is zero, the value is the mean of all lines on the same side of the face, or else in the row.

    Args:
        sums, lines: (..., n_patches), lines of each patch, whole or weighted.
        side: (n_patches,), see `sides`.
    """
    lines = np.broadcast_to(lines, sums.shape)
    met = lines > 0
    result = np.divide(sums, lines, out=np.zeros(sums.shape), where=met)
    if met.all():
        return result
    n = len(side)
    for row, count, known, values in zip(*(x.reshape(-1, n) for x in (sums, lines, met, result)), strict=True):
        if known.all():
            continue
        total, number = (np.bincount(side, x) for x in (row, count))
        usual = np.full(len(total), total.sum() / max(number.sum(), np.finfo(float).tiny))
        np.divide(total, number, out=usual, where=number > 0)
        values[~known] = usual[side[~known]]
    return result


def bias(values: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """The bias of the mean over replicates, (n_patches,): all of what patches without lines were given.

    Args:
        values, lines: (replicates, n_patches).
    """
    return np.where(lines > 0, 0.0, values).mean(axis=0)


def warn(patches: Patches, lines: np.ndarray) -> None:
    """Warn of patches that no line measured, where they are more than `TOLD` of the area.

    Args:
        lines: (replicates, n_patches).
    """
    share = float(((lines == 0) @ patches.area).mean() / patches.area.sum())
    if share > TOLD:
        warnings.warn(
            f"{share:.0%} of the area of {len(patches):,} patches was measured by no line in the mean of {len(lines)} replicates "
            f"({lines.mean():.3g} lines a patch and replicate): there the mean of the face stands, and counts as an error of its "
            "own size; take more lines, larger patches, or fewer replicates",
            RadiosityWarning,
            stacklevel=6,
        )
