"""Smoothed hits: local linear fits that keep the power of each flat region, and their bias."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..patches.model import Patches
from .errors import mean_and_error
from .local_linear import Regions, weights

ALIKE = 0.5  # of a region's power: a fit that holds less than this of it is no fit


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
        """The fits with the bandwidths that follow from (n_patches,) hits."""
        regions = Regions.find(patches)
        fit, near = (weights(regions, arrivals, patches.centroid, regions.of, planes=planes) for planes in (True, False))
        return Smoother(regions, fit, near)

    def smooth(self, power: np.ndarray) -> np.ndarray:
        """(replicates, n_patches) received power, fitted, and scaled so that each region keeps its own in each replicate.

        So sums over regions and surfaces have no bias. A region whose fit holds hardly any of its power is left as counted.
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
        """(n_patches,) root mean square bias of the smoothed power about each patch; NaN for a single replicate.

        Counts have no bias, so the mean of smoothed less counted is the bias, and the square of that mean less its variance
        estimates the squared bias without bias. A patch alone says little: its neighbours within the kernel, whose bias is of
        one kind, are averaged.
        """
        area = self.regions.patches.area
        mean, error = mean_and_error((smoothed - power) / area)
        return np.sqrt(np.maximum(self.near @ (mean**2 - error**2), 0)) * area
