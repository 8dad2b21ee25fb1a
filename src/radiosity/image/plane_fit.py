"""Values smoothed across planes that vertices do not smooth: faces of triangles, and cells that meet at hanging nodes.

Interpolated between the corners of long triangles, light has streaks along them, and where one cell meets two smaller ones it has
steps. There the value at a point is a linear fit to the patches around it, in the same plane of the same surface, whose faces no
contact line holds apart (`scene.cut`). The patch farthest away of those has no weight, so that values change without steps. Small
patches make a narrow fit: where patches follow the edge of a shadow it stays as sharp as they are.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..patches import Patches
from .display_mesh import DisplayMesh

AROUND = 16  # patches of a fit, the farthest without weight
LEAST = 4  # patches of a plane: fewer make no fit
STEPS, THIN = 200, 1e-4  # normals and distances of planes that round to the same multiple are one
UNLIKE = 1.5  # ratio of the sides of cells in a plane, above which some meet at hanging nodes
CHUNK = 1 << 16  # points at a time


@dataclass(frozen=True, eq=False)
class PlaneFit:
    """The patches of a solution by planes."""

    patches: Patches

    @cached_property
    def plane(self) -> np.ndarray:
        """The number of each patch's plane, surface and side, (n_patches,) int64; -1 where vertices smooth well."""
        patches, scene = self.patches, self.patches.scene
        normal = np.round(scene.normal * STEPS)
        offset = np.einsum("ij,ij->i", scene.normal, scene.frames[0] - scene.centre)
        key = np.column_stack([scene.surface, normal, np.round(offset / (THIN * scene.reach))])
        number = np.unique(key, axis=0, return_inverse=True)[1].ravel()
        uneven = self._uneven(number)[number]
        if scene.cut is not None:
            apart = np.unique(np.column_stack([number, scene.cut.region]), axis=0, return_inverse=True)[1].ravel()
            parts = np.bincount(np.unique(np.column_stack([number, apart]), axis=0)[:, 0])
            uneven, number = uneven | (parts[number] > 1), apart
        return np.where(uneven[patches.face], 2 * number[patches.face] + patches.is_back, -1)

    def _uneven(self, number: np.ndarray) -> np.ndarray:
        """Return which planes have triangles beside other faces, or cells of unlike size in a cut scene, (n_planes,) bool."""
        patches, scene = self.patches, self.patches.scene
        _, first, second = scene.frames
        triangles = np.bincount(number, ~scene.is_quad) > 0
        least, most = np.full(len(triangles), np.inf), np.zeros(len(triangles))
        for edge, cells in ((first, patches.columns), (second, patches.rows)):
            side = np.linalg.norm(edge, axis=1) / cells
            np.minimum.at(least, number, side)
            np.maximum.at(most, number, side)
        unlike = np.full(len(least), scene.cut is not None) & (most > UNLIKE * least)
        enough = np.bincount(number, patches.cells_per_face) >= LEAST
        return np.asarray(enough & (np.bincount(number) > 1) & (triangles | unlike))

    @cached_property
    def _tree(self):
        """A tree of the centroids of uneven planes, which lie apart along a fourth axis, and their patches."""
        from scipy.spatial import KDTree

        rows = np.flatnonzero(self.plane >= 0)
        apart = 4 * self.patches.scene.reach + 1e-300
        places = np.column_stack([self.patches.centroid[rows], self.plane[rows] * apart])
        return KDTree(places), rows, apart

    def fits(self, patch: np.ndarray) -> np.ndarray:
        """Return which patches lie in planes that are fitted, (m,) bool."""
        return self.plane[patch] >= 0

    def at(self, values: np.ndarray, patch: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Return the fit at points of patches that are fitted, (m, n).

        Args:
            values: (n_patches, n) of patches; unknown (NaN) ones are left out.
            patch: (m,) on which each point lies.
            points: (m, 3) metres.
        """
        if not len(patch):
            return np.zeros((0, values.shape[1]))
        steps = (slice(at, at + CHUNK) for at in range(0, len(patch), CHUNK))
        return np.concatenate([self._at(values, patch[rows], points[rows]) for rows in steps])

    def _at(self, values: np.ndarray, patch: np.ndarray, points: np.ndarray) -> np.ndarray:
        tree, rows, apart = self._tree
        count = min(AROUND, len(rows))
        distance, near = tree.query(np.column_stack([points, self.plane[patch] * apart]), k=count)
        near = rows[near]
        same = np.asarray(self.plane[near] == self.plane[patch][:, None])
        reach = np.where(same, distance, 0).max(axis=1, keepdims=True) * (1 + 1e-9) + 1e-300
        weight = np.where(same, (1 - np.minimum(distance / reach, 1) ** 2) ** 2, 0.0) * self.patches.area[near]
        found = values[near]
        known = np.asarray(np.isfinite(found).all(axis=2))
        weight = np.where(known, weight, 0.0)
        found = np.where(known[..., None], found, 0.0)
        total = weight.sum(axis=1, keepdims=True)
        alone = total[:, 0] <= 0
        weight /= np.where(total > 0, total, 1.0)
        way = (self.patches.centroid[near] - points[:, None]) / reach[..., None]
        mean = np.einsum("mk,mkn->mn", weight, found)
        middle = np.einsum("mk,mki->mi", weight, way)
        about = way - middle[:, None]
        moments = np.einsum("mk,mki,mkj->mij", weight, about, about)
        slope = np.einsum("mk,mki,mkn->min", weight, about, found - mean[:, None])
        trace = np.trace(moments, axis1=1, axis2=2)[:, None, None]
        steady = moments + (1e-2 * trace + 1e-12) * np.eye(3)  # a plane's moments have no third axis
        result = mean - np.einsum("mi,min->mn", middle, np.linalg.solve(steady, slope))
        shown = np.where(np.expand_dims(weight > 0, -1), found, np.nan)
        with np.errstate(invalid="ignore"):
            low, high = (f(np.where(np.isnan(shown), fill, shown), axis=1) for f, fill in ((np.min, np.inf), (np.max, -np.inf)))
        return np.where(alone[:, None], values[patch], np.clip(result, low, high))


def at_vertices(patches: Patches, mesh: DisplayMesh, values: np.ndarray) -> np.ndarray:
    """Return smoothed values at the vertices of a mesh, (n_vertices, n): fits where a vertex lies in one uneven plane alone.

    Args:
        values: (n_patches, n); NaN where unknown.
    """
    found, fit = mesh.smoothed(values), PlaneFit(patches)
    if not (fit.plane >= 0).any():
        return found
    plane, corner = np.repeat(fit.plane, 4), mesh.polygons.ravel()
    least, most = np.full(len(found), np.iinfo(np.int64).max), np.full(len(found), -1)
    np.minimum.at(least, corner, plane)
    np.maximum.at(most, corner, plane)
    owner = np.zeros(len(found), np.int64)
    owner[corner] = np.repeat(np.arange(len(patches)), 4)
    alone = np.flatnonzero((least == most) & (most >= 0))
    found[alone] = fit.at(values, owner[alone], mesh.vertices[alone])
    return found
