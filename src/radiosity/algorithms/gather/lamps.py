"""Lamps: the sides of faces that emit."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...device.backend import upload
from ...problem.model import Problem
from ...tally.unmet import sides as side_of
from ...tracing.faces import COLUMN_BITS, QUAD
from ...tracing.geometry import Geometry

NONE = 0xFFFFFFFF  # in place of a lamp's number


@dataclass(frozen=True, eq=False)
class Lamps:
    """The lamps of a scene."""

    geometry: Geometry
    problem: Problem

    @cached_property
    def sides(self) -> np.ndarray:
        """The lamps, (n_lamps, 2) int64: face, and 1 for its back. Neighbours follow each other."""
        patches = self.problem.patches
        lit = self.problem.groups.emission.any(axis=1)
        face, back = np.divmod(np.unique(side_of(patches)[lit]), 2)
        centre = self.geometry.faces.corners[face].mean(axis=1)
        scaled = np.floor((centre - centre.min(axis=0)) / max(np.ptp(centre, axis=0).max(), 1e-300) * 1023)
        order = np.lexsort((*scaled.T, *np.floor(scaled / 64).T))
        return np.column_stack([face, back])[order]

    def __len__(self) -> int:
        return len(self.sides)

    @cached_property
    def first(self) -> np.ndarray:
        """The first patch of each lamp, (n_lamps,) int64."""
        patches, (face, back) = self.problem.patches, self.sides.T
        return patches.first[face] + back * patches.cells_per_face[face]

    @cached_property
    def cells(self) -> np.ndarray:
        """The number of patches of each lamp, (n_lamps,) int64."""
        return self.problem.patches.cells_per_face[self.sides[:, 0]]

    @cached_property
    def of_patch(self) -> np.ndarray:
        """The lamp of each patch, (n_patches + 2,) int64; -1 for patches of other faces, and for codes of lost lines."""
        found = np.full(len(self.problem.patches) + 2, -1)
        found[np.repeat(self.first - np.cumsum(self.cells) + self.cells, self.cells) + np.arange(self.cells.sum())] = np.repeat(
            np.arange(len(self)), self.cells
        )
        return found

    @cached_property
    def power(self) -> np.ndarray:
        """The share of each lamp in the power of all, its largest group of bands counted, (n_lamps,) float64."""
        patches, groups = self.problem.patches, self.problem.groups
        scaled = (groups.emission / np.maximum(groups.emission.max(axis=0), 1e-300)).max(axis=1) * patches.area
        power = np.bincount(self.of_patch[:-2][self.of_patch[:-2] >= 0], scaled[self.of_patch[:-2] >= 0], len(self))
        return power / power.sum()

    @cached_property
    def area(self) -> np.ndarray:
        """The area of each lamp in the BVH's units, (n_lamps,) float64."""
        return self.geometry.scene.area[self.sides[:, 0]] * self.geometry.bvh.scale**2

    @cached_property
    def facing(self) -> np.ndarray:
        """Unit normals towards the side that emits, (n_lamps, 3) float64."""
        face, back = self.sides.T
        return self.geometry.faces.normals[face] * np.where(back, -1.0, 1.0)[:, None]

    @cached_property
    def corners(self) -> np.ndarray:
        """Corners, (n_lamps, 4, 3) float64, in the BVH's coordinates; a triangle repeats its last one."""
        return self.geometry.faces.corners[self.sides[:, 0]]

    # ---- on the device ---------------------------------------------------------------------------------------------

    def prepare(self) -> None:
        """Make what kernels read."""
        _ = self.records, self.lamp_of_patch, self.normals

    @property
    def types(self):
        return self.geometry.device.types

    @cached_property
    def records(self):
        """Face (top bit: its back), cell counts and flags, first patch, and number of patches of lamps, (n_lamps * 4,) UInt32."""
        patches, (face, back) = self.problem.patches, self.sides.T
        counts = patches.columns[face] | patches.rows[face].astype(np.int64) << COLUMN_BITS
        counts |= np.where(patches.scene.is_quad[face], QUAD, 0)
        rows = np.column_stack([face | back << 31, counts, self.first, self.cells])
        return upload(self.types.UInt32, rows.astype(np.uint32))

    @cached_property
    def lamp_of_patch(self):
        """The lamp of each patch, (n_patches + 2,) UInt32, `NONE` for others."""
        return upload(self.types.UInt32, np.where(self.of_patch < 0, NONE, self.of_patch).astype(np.uint32))

    @cached_property
    def normals(self):
        """Unit normals of lamps, (n_lamps * 3,) Float."""
        return upload(self.types.Float, self.facing.astype(np.float32))
