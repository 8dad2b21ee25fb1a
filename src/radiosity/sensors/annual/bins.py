"""What lines bring from each sky patch: a table of receivers and patches."""

from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import small, upload
from ...scene.lights.sky_patches import SkyPatches


class Bins:
    """A table of what lines bring to each lane from each sky patch, in fixed point, so that no order of sums matters.

    Attributes:
        patches: the subdivision of the sky.
        table: (lanes * n_sky_patches,) Int64.
    """

    def __init__(self, patches: SkyPatches, axes: np.ndarray, lanes: int, types: Any):
        """Make an empty table.

        Args:
            axes: (3, 3), directions of north, east and up, see `scene.lights.axes.sky_axes`.
        """
        self.patches, self.types, self._of = patches, types, (patches, axes, lanes, types)
        self._axes = [types.Array3f(*axis) for axis in axes.tolist()]
        self._counts = small(types.UInt32, np.append(patches.counts, 1).astype(np.uint32))
        self._starts = small(types.UInt32, patches.starts.astype(np.uint32))
        self.table = dr.zeros(types.Int64, lanes * len(patches))
        dr.eval(self.table)

    def __call__(self, lane: Any, direction: Any, value: Any) -> None:
        """Add a value of each lane to the sky patch that a direction leads to; called in a kernel."""
        types = self.types
        here = value > 0
        place = types.UInt32(lane) * len(self.patches) + self.number(direction, here)
        dr.scatter_add(self.table, types.Int64(value), place, active=here)

    def number(self, direction: Any, active: Any) -> Any:
        """Return the sky patch that each unit direction leads to, UInt32; called in a kernel."""
        types, patches = self.types, self.patches
        north, east, up = (dr.dot(axis, direction) for axis in self._axes)
        height = dr.asin(dr.clip(up, -1, 1)) * (1 / patches.step)
        row = dr.minimum(types.UInt32(dr.maximum(height, 0)), len(patches.counts))
        count = dr.gather(types.UInt32, self._counts, row, active)
        turns = dr.atan2(east, north) * (1 / (2 * np.pi))
        whole = types.Float(count)
        column = types.UInt32(dr.select(turns < 0, turns + 1, turns) * whole + 0.5)
        column = dr.select(column >= count, column - count, column)
        return dr.select(up < 0, types.UInt32(len(patches) - 1), dr.gather(types.UInt32, self._starts, row, active) + column)

    def emptied(self) -> "Bins":
        """Return an empty table for the same lanes."""
        return Bins(*self._of)

    def add(self, table: np.ndarray) -> None:
        """Add the table of other lines of the same lanes."""
        self.table += upload(self.types.Int64, table)
        dr.eval(self.table)

    def values(self) -> np.ndarray:
        """Return the table, (lanes, n_sky_patches) float64."""
        return np.array(self.table, np.float64).reshape(-1, len(self.patches))
