"""Boxes around clusters of receivers, and bounds of what lamps send into them."""

from dataclasses import dataclass

import numpy as np

from .lamps import Lamps
from .packets import Packets

GRAZING = 0.02  # least cosine that is counted
SLACK = 1e-5  # of the coordinates: what is no further behind a plane counts as in front of it


@dataclass(frozen=True, eq=False)
class Boxes:
    """Clusters of receivers, in the BVH's coordinates.

    Attributes:
        middle, half: (k, 3) float64, of each cluster's box: its centre and half its size.
        normal: (k, 3) float64, the mean direction of its patches' normals.
        lean: (k,) float64, the cosine by which a normal leans from it at most.
    """

    middle: np.ndarray
    half: np.ndarray
    normal: np.ndarray
    lean: np.ndarray

    @staticmethod
    def of(packets: Packets, size: int) -> "Boxes":
        """Make the boxes of clusters of ``size`` lanes."""
        low, high, normals = packets.extents()
        starts = np.arange(0, len(low), size)
        low, high = np.minimum.reduceat(low, starts), np.maximum.reduceat(high, starts)
        mean = np.add.reduceat(normals, starts)
        length = np.linalg.norm(mean, axis=1, keepdims=True)
        mean = np.divide(mean, length, out=np.zeros_like(mean), where=length > 0)
        of_lane = np.repeat(mean, np.diff(np.append(starts, len(normals))), axis=0)
        lean = np.minimum.reduceat((normals * of_lane).sum(axis=1), starts)
        return Boxes((low + high) / 2, (high - low) / 2, mean, np.clip(lean, -1, 1))

    def take(self, rows: slice) -> "Boxes":
        """Return some of the clusters."""
        return Boxes(self.middle[rows], self.half[rows], self.normal[rows], self.lean[rows])

    def unobstructed(self, lamps: Lamps) -> np.ndarray:
        """Return about the irradiance by each lamp of power 1 at each cluster where nothing is between, (k, n_lamps) float64."""
        corners, facing = lamps.corners, lamps.facing
        centre = corners.mean(axis=1)
        size = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
        radius = np.linalg.norm(self.half, axis=1)[:, None]
        square = (centre**2).sum(axis=1) + (self.middle**2).sum(axis=1)[:, None] - 2 * self.middle @ centre.T
        distance = np.sqrt(np.maximum(square, 1e-12))
        spread = np.minimum((radius + size) / distance, 1.0)  # sine of how far directions lean from that of the centres
        turned = spread + np.sqrt(1 - self.lean**2)[:, None]
        along = self.normal @ centre.T - (self.normal * self.middle).sum(axis=1)[:, None]
        here = np.where(self.lean[:, None] <= 0, 1.0, np.clip(along / distance + turned, GRAZING, 1))
        back = self.middle @ facing.T - (centre * facing).sum(axis=1)
        there = np.clip(back / distance + spread, GRAZING, 1)
        return here * there / (np.maximum(square, 0) + 2 / 3 * radius**2 + lamps.area / np.pi)

    def largest_kernel(self, lamps: Lamps) -> np.ndarray:
        """Return a bound of cos cos' / (pi r^2) between points of clusters and of lamps, (k, n_lamps) float64."""
        corners, facing = lamps.corners, lamps.facing
        low, high = corners.min(axis=1), corners.max(axis=1)
        apart = np.abs(self.middle[:, None] - (low + high) / 2) - self.half[:, None] - (high - low) / 2
        distance = np.maximum(np.linalg.norm(np.maximum(apart, 0.0), axis=2), 1e-9)
        there = self.middle @ facing.T + self.half @ np.abs(facing).T - (corners[:, 0] * facing).sum(axis=1)
        here = self._heights(lamps)
        here = np.where((self.lean > 1 - 1e-9)[:, None], here, np.inf)
        return np.clip(here / distance, 0, 1) * np.clip(there / distance, 0, 1) / (np.pi * distance**2)

    def _heights(self, lamps: Lamps) -> np.ndarray:
        """Return how high lamps reach above the lowest point of boxes along their normals, (k, n_lamps) float64."""
        lowest = (self.middle * self.normal).sum(axis=1) - (self.half * np.abs(self.normal)).sum(axis=1)
        highest = (self.normal @ lamps.corners.reshape(-1, 3).T).reshape(len(self.normal), -1, 4).max(axis=2)
        return highest - lowest[:, None]

    def behind(self, lamps: Lamps) -> np.ndarray:
        """Return where no light can arrive, (k, n_lamps) bool: the cluster is behind the lamp, or the lamp behind the cluster."""
        corners, facing = lamps.corners, lamps.facing
        slack = SLACK * (np.abs(corners).max() + np.abs(self.middle).max())
        reach = self.middle @ facing.T + self.half @ np.abs(facing).T  # the box's highest corner above the lamp's plane
        below = reach < (corners[:, 0] * facing).sum(axis=1) - slack
        return below | ((self.lean > 1 - 1e-9)[:, None] & (self._heights(lamps) < -slack))
