"""The warning about lights that few lines of a line set begin at: lines are shared by area, whatever emits."""

import warnings

import numpy as np

from ...errors import RadiosityWarning, shown
from ...patches import Patches

FEW = 30  # lines of a light in a replicate: with fewer, intervals hold less often than they say
DIM = 0.01  # of the emitted power: dimmer surfaces are not told


def warn_of_starved(patches: Patches, lines: np.ndarray) -> None:
    """Warn of surfaces that emit much of the power and have few lines.

    Args:
        lines: (replicates, n_patches), lines that left each patch.
    """
    n, emits = len(patches.scene.names), patches.emission.any(axis=1)
    each = np.bincount(patches.surface[emits], lines.mean(axis=0)[emits], n)
    power = np.stack([np.bincount(patches.surface, patches.area * band, n) for band in patches.emission.T], axis=1)
    share = (power / np.maximum(power.sum(axis=0), np.finfo(float).tiny)).max(axis=1)
    starved = np.flatnonzero((share > DIM) & (each < FEW))
    if len(starved):
        names = shown([patches.scene.names[i] for i in starved])
        warnings.warn(
            f"few lines begin at what emits: {names} (from {each[starved].min():.3g} lines in a replicate; errors are large and "
            f"rough below {FEW}); trace more lines, or lines with sources=[{patches.scene.names[starved[0]]!r}]",
            RadiosityWarning,
            stacklevel=3,
        )
