"""Lamps: the sides of faces that emit, and the sides of openings through which the sky shines."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...device.backend import upload
from ...problem.lights.openings import Openings
from ...problem.model import Problem
from ...tally.unmet import sides as side_of
from ...tracing.faces import COLUMN_BITS, QUAD
from ...tracing.geometry import Geometry

NONE = 0xFFFFFFFF  # in place of a lamp's number


@dataclass(frozen=True, eq=False)
class Lamps:
    """The lamps of a scene: sides of faces come first, then both sides of each opening."""

    geometry: Geometry
    problem: Problem

    @cached_property
    def sides(self) -> np.ndarray:
        """The lamps that are faces, (n_faces, 2) int64: face, and 1 for its back. Neighbours follow each other."""
        patches = self.problem.patches
        lit = self.problem.groups.emission.any(axis=1)
        face, back = np.divmod(np.unique(side_of(patches)[lit]), 2)
        if not len(face):
            return np.zeros((0, 2), np.int64)
        centre = self.geometry.faces.corners[face].mean(axis=1)
        scaled = np.floor((centre - centre.min(axis=0)) / max(np.ptp(centre, axis=0).max(), 1e-300) * 1023)
        order = np.lexsort((*scaled.T, *np.floor(scaled / 64).T))
        return np.column_stack([face, back])[order]

    @cached_property
    def openings(self) -> Openings | None:
        """Openings into the sky, where there are any."""
        lights = self.problem.patches.scene.lights
        if self.problem.lights is None or self.problem.lights.sky is None or lights.openings is None:
            return None
        return Openings(self.geometry, lights.openings) if len(lights.openings) else None

    @property
    def n_faces(self) -> int:
        """The number of lamps that are sides of faces."""
        return len(self.sides)

    def __len__(self) -> int:
        return self.n_faces + (0 if self.openings is None else 2 * len(self.openings))

    @cached_property
    def first(self) -> np.ndarray:
        """The first patch of each lamp that is a face, (n_faces,) int64."""
        patches, (face, back) = self.problem.patches, self.sides.T
        return patches.first[face] + back * patches.cells_per_face[face]

    @cached_property
    def cells(self) -> np.ndarray:
        """The number of patches of each lamp that is a face, (n_faces,) int64."""
        return self.problem.patches.cells_per_face[self.sides[:, 0]]

    @cached_property
    def of_patch(self) -> np.ndarray:
        """The lamp of each patch, (n_patches + 2,) int64; -1 for patches of other faces, and for codes of lost lines."""
        found = np.full(len(self.problem.patches) + 2, -1)
        found[np.repeat(self.first - np.cumsum(self.cells) + self.cells, self.cells) + np.arange(self.cells.sum())] = np.repeat(
            np.arange(self.n_faces), self.cells
        )
        return found

    @cached_property
    def emission(self) -> np.ndarray:
        """Mean emission of each lamp, or of the sky, (n_lamps, n_groups) float64, in shares of the unit."""
        groups, unit = self.problem.groups, np.maximum(self.problem.unit, 1e-300)
        shares = groups.emission / unit
        emission = shares[self.first]
        lit = np.flatnonzero(self.of_patch[:-2] >= 0)
        uneven = np.flatnonzero(np.bincount(self.of_patch[lit], (shares[lit] != emission[self.of_patch[lit]]).any(axis=1)))
        for lamp in uneven:
            emission[lamp] = shares[self.first[lamp] : self.first[lamp] + self.cells[lamp]].mean(axis=0)
        if self.openings is None:
            return emission
        sky = self.problem.patches.scene.lights.sky
        assert sky is not None
        mean = np.broadcast_to(sky.flux / 4, len(self.problem.patches.scene.bands))[groups.leaders] / unit
        return np.concatenate([emission, np.tile(mean, (2 * len(self.openings), 1))])

    @cached_property
    def light(self) -> np.ndarray:
        """The power of each lamp over that of its largest group of bands' unit, (n_lamps,) float64, m²."""
        patches, groups, unit = self.problem.patches, self.problem.groups, np.maximum(self.problem.unit, 1e-300)
        scaled = (groups.emission / unit).max(axis=1) * patches.area
        power = np.bincount(self.of_patch[:-2][self.of_patch[:-2] >= 0], scaled[self.of_patch[:-2] >= 0], self.n_faces)
        if self.openings is None:
            return power
        of_sky = self.emission[self.n_faces :].max(axis=1)
        return np.append(power, np.tile(self.openings.area, 2) / self.geometry.bvh.scale**2 * of_sky)

    @cached_property
    def power(self) -> np.ndarray:
        """The share of each lamp in the power of all, (n_lamps,) float64."""
        return self.light / self.light.sum()

    @cached_property
    def area(self) -> np.ndarray:
        """The area of each lamp in the BVH's units, (n_lamps,) float64."""
        area = self.geometry.scene.area[self.sides[:, 0]] * self.geometry.bvh.scale**2
        return area if self.openings is None else np.append(area, np.tile(self.openings.area, 2))

    @cached_property
    def facing(self) -> np.ndarray:
        """Unit normals towards the side that emits, (n_lamps, 3) float64."""
        face, back = self.sides.T
        facing = self.geometry.faces.normals[face] * np.where(back, -1.0, 1.0)[:, None]
        return facing if self.openings is None else np.concatenate([facing, self.openings.normal, -self.openings.normal])

    @cached_property
    def corners(self) -> np.ndarray:
        """Corners, (n_lamps, 4, 3) float64, in the BVH's coordinates; a triangle repeats its last one."""
        corners = self.geometry.faces.corners[self.sides[:, 0]]
        return corners if self.openings is None else np.concatenate([corners, *[self.openings.placed] * 2])

    # ---- on the device ---------------------------------------------------------------------------------------------

    def prepare(self) -> None:
        """Make what kernels read."""
        _ = self.records, self.lamp_of_patch, self.normals
        if self.openings is not None:
            self.openings.prepare()

    @property
    def types(self):
        return self.geometry.device.types

    @cached_property
    def records(self):
        """Face (top bit: its back), cell counts and flags, first patch, and number of patches of lamps that are faces: UInt32."""
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
