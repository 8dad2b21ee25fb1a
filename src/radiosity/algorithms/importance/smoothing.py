"""Rough values of patches from few hits: where a patch has few, the mean around it counts for more.

Patches belong to blocks of space, smaller and larger ones, and to the direction that they look in most. A value is the mean of
what the patch received and of its block, each weighted by its number of hits; the block's in turn that of the larger block.
"""

from dataclasses import dataclass

import numpy as np

from ...patches.model import Patches

BLOCKS = (6, 24)  # blocks along the longest side of the scene, from large to small
ENOUGH = 4.0  # hits for which a mean counts as much as that of the larger block


@dataclass(frozen=True, eq=False)
class Blocks:
    """Blocks of patches.

    Attributes:
        area: (n_patches,) m².
        levels: (n_patches,) int64 each, the block of each patch, from large to small.
    """

    area: np.ndarray
    levels: tuple[np.ndarray, ...]

    @staticmethod
    def of(patches: Patches) -> "Blocks":
        """Sort patches into blocks by their centroids and normals."""
        place, normal = patches.centroid, patches.normal
        low = place.min(axis=0)
        longest = max(float((place.max(axis=0) - low).max()), 1e-30)
        axis = np.abs(normal).argmax(axis=1)
        side = 2 * axis + (np.take_along_axis(normal, axis[:, None], 1)[:, 0] > 0)
        levels = []
        for count in BLOCKS:
            cell = np.minimum((place - low) / longest * count, count - 1).astype(np.int64)
            levels.append(np.unique(((cell[:, 0] * count + cell[:, 1]) * count + cell[:, 2]) * 6 + side, return_inverse=True)[1])
        return Blocks(patches.area, tuple(levels))

    def smooth(self, power: np.ndarray, hits: np.ndarray) -> np.ndarray:
        """Return power by area, (n_patches,); where nothing was received in a large block, the least value of all others."""
        value: np.ndarray | None = None
        for key in self.levels:
            area, total, count = (np.bincount(key, x) for x in (self.area, power, hits))
            trust = count / (count + ENOUGH)
            value = total / area if value is None else trust * (total / area) + (1 - trust) * _first(key, value)
            value = value[key]
        assert value is not None
        trust = hits / (hits + ENOUGH)
        value = trust * power / self.area + (1 - trust) * value
        known = value > 0
        return np.where(known, value, value[known].min() if known.any() else 1.0)


def _first(key: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Return the value of the first patch of each block: patches of a block are of one larger block."""
    return value[np.unique(key, return_index=True)[1]]
