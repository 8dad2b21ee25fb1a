"""Smoothed hits: local linear fits that keep the power of each flat region, and their bias."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..patches.model import Patches
from .errors import mean_and_error
from .local_linear import Regions, weights

ALIKE = 0.5  # share of a region's power that a fit must hold at least


@dataclass(frozen=True, eq=False)
class Smoother:
    """The fits of a run.

    Attributes:
        regions: flat regions.
        fit: (n_patches, n_patches) sparse matrix, planes fitted about each patch.
        near: the same shape, the kernel's means about each patch; no weight is negative.
    """

    regions: Regions
    fit: Any
    near: Any

    @staticmethod
    def of(patches: Patches, arrivals: np.ndarray) -> "Smoother":
        """Return the fits with the bandwidths that follow from (n_patches,) hits."""
        regions = Regions.find(patches)
        fit, near = (weights(regions, arrivals, patches.centroid, regions.of, planes=planes) for planes in (True, False))
        return Smoother(regions, fit, near)

    def smooth(self, power: np.ndarray) -> np.ndarray:
        """The received power, fitted, and scaled so that each region keeps its power in each replicate, (replicates, n_patches).

        So sums over regions and surfaces have no bias. A region whose fit holds less than `ALIKE` of its power stays as counted.
        """
        area, of = self.regions.patches.area, self.regions.of
        result = []
        for row in power:
            fitted = self.fit @ (row / area) * area
            landed, held = (np.bincount(of, x, self.regions.count) for x in (row, fitted))
            usable = held > ALIKE * landed
            scale = np.where(usable, landed / np.where(usable, held, 1), 1)
            result.append(np.where(usable[of], fitted * scale[of], row))
        return np.stack(result)

    def bias(self, power: np.ndarray, smoothed: np.ndarray) -> np.ndarray:
        """The root mean square bias of the smoothed power about each patch, (n_patches,); NaN for a single replicate.

        Counts have no bias, so the mean of smoothed less counted is the bias, and the square of that mean less its variance
        estimates the squared bias without bias. The estimate of a single patch is noisy, so it is averaged over its neighbours
        within the kernel, which have a similar bias.
        """
        area = self.regions.patches.area
        mean, error = mean_and_error((smoothed - power) / area)
        return np.sqrt(np.maximum(self.near @ (mean**2 - error**2), 0)) * area
