"""What the size of patches does to a discrete solution: the change where every patch is cut into four."""

import numpy as np

import radiosity as rd
from radiosity.patches.nesting import halved, parents

from .points import on_patches
from .runs import Runs

# the error of constant radiosity on a patch falls at least in proportion to its size: of the coarse solution's error at most half
# is left in the fine one's, so that it is at most twice the change
FACTOR = 2.0


def error(runs: Runs, rays: float, method: str) -> np.ndarray:
    """(n_patches, n_bands) discretisation error of irradiance to expect: the RMS over each surface, since the change of a single
    patch is small by chance where it passes through zero. The noise of both solutions is in it.

    Args:
        rays: for the finer solution.
    """
    coarse, fine = runs.patches, halved(runs.patches)
    found = rd.solve(fine, method, rays=rays, replicates=8, seed=12345)
    parent = parents(fine, coarse)
    total = np.stack([np.bincount(parent, fine.area * band, len(coarse)) for band in found.irradiance.T], axis=1)
    square = (runs.irradiance.mean(axis=0) - total / coarse.area[:, None]) ** 2
    surface, area = coarse.surface, coarse.area
    sums = np.stack([np.bincount(surface, area * band) for band in square.T], axis=1)
    return FACTOR * np.sqrt(sums / np.maximum(np.bincount(surface, area), 1e-300)[:, None])[surface]


def resolved(patches: rd.Patches, points: int = 16) -> np.ndarray:
    """(n_patches,) bool: nothing lies in front of the patch nearer than a tenth of its size. Elsewhere, as between a lamp and the
    ceiling that it hangs a millimetre below, what halving changes says nothing of the error."""
    from radiosity.tracing.first_hits import first_hits

    generator = np.random.Generator(np.random.Philox(3))
    size = np.sqrt(patches.area)
    normal = np.repeat(patches.normal, points, axis=0)
    start = on_patches(patches, points, generator).reshape(-1, 3) + 1e-5 * normal * np.repeat(size, points)[:, None]
    distance = first_hits(patches.scene, start, normal).distance.reshape(len(patches), points)
    return distance.min(axis=1) > size / 10
