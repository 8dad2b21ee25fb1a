"""Groups of bands: bands of a group are one problem (contract 3)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..patches.model import Patches
from ..patches.scatter import Scatter

QUANTUM = 2**31  # fixed point units of a quantum: a hit adds at most one quantum, and 2^32 quanta fit in 64 bits


@dataclass(frozen=True, eq=False)
class BandGroups:
    """Groups of bands whose reflectances are equal everywhere and whose emissions are proportional: a group is solved once.

    Attributes:
        index: (n_bands,) int, the group of each band.
        scale: (n_bands,) float64: the band's emission over the group's.
        emission, reflectance: (n_patches, n_groups) float64, of each group.
        leaders: (n_groups,) int, the band that each group has its values from.
        through: (n_patches, n_groups) float64, the diffuse transmittance of each group; None where nothing diffuses light.
        other: (n_patches,) int64, the patch on the other side of each; None where nothing diffuses light.
    """

    index: np.ndarray
    scale: np.ndarray
    emission: np.ndarray
    reflectance: np.ndarray
    leaders: np.ndarray
    through: np.ndarray | None = None
    other: np.ndarray | None = None

    @staticmethod
    def of(patches: Patches, light_power: np.ndarray | None = None) -> "BandGroups":
        """Compare the bands of a scene, and of its lights without area, (n_lights, n_bands)."""
        emission, reflectance, through = patches.emission, patches.reflectance, patches.diffuse_transmittance
        n_patches = len(emission)
        if light_power is not None and len(light_power):
            emission = np.concatenate([emission, light_power])
        n_bands = emission.shape[1]
        index, scale, leaders = np.zeros(n_bands, np.int64), np.zeros(n_bands), []
        for band in sorted(range(n_bands), key=lambda b: (not emission[:, b].any(), b)):
            if leaders and not emission[:, band].any():
                continue  # the band emits nothing: it is any group times zero
            for group, leader in enumerate(leaders):
                at = int(np.argmax(emission[:, leader]))
                ratio = emission[at, band] / emission[at, leader] if emission[at, leader] else 0.0
                if (
                    ratio
                    and np.array_equal(reflectance[:, band], reflectance[:, leader])
                    and (through is None or np.array_equal(through[:, band], through[:, leader]))
                    and np.allclose(emission[:, band], ratio * emission[:, leader], rtol=1e-14, atol=0)
                ):
                    index[band], scale[band] = group, ratio
                    break
            else:
                index[band], scale[band] = len(leaders), 1.0
                leaders.append(band)
        if leaders != list(range(n_bands)):  # else they are the patches' own arrays, which need no copy
            emission, reflectance = emission[:, leaders], reflectance[:, leaders]
            through = None if through is None else through[:, leaders]
        other = None if through is None else patches.other_side
        return BandGroups(index, scale, emission[:n_patches], reflectance, np.array(leaders, np.int64), through, other)

    @cached_property
    def scatter(self) -> Scatter:
        """What patches send on of the light that they receive, of each group."""
        return Scatter(self.reflectance, self.through, self.other)

    @property
    def n_groups(self) -> int:
        return self.emission.shape[1]
