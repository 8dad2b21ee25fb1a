"""The lookup of what lines of sight see: the patch that was hit, and the value there."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..patches import Patches, cells
from ..patches.polynomials import Polynomials
from ..scene import Back
from . import polynomial_light
from .display_mesh import DisplayMesh, build
from .plane_fit import PlaneFit


@dataclass(frozen=True, eq=False)
class Lookup:
    """Values (n_patches, n) of patches, found from hits.

    With ``smooth`` they are interpolated between smoothed vertex values. ``light`` has the polynomials that values are the means
    of, where there are any; without ``smooth`` these are shown as they are.
    """

    patches: Patches
    values: np.ndarray
    smooth: bool = True
    light: Polynomials | None = None

    @cached_property
    def mesh(self) -> DisplayMesh:
        return build(self.patches)

    @cached_property
    def at_vertices(self) -> np.ndarray:
        return self.mesh.smoothed(self.values)

    @cached_property
    def moves(self) -> np.ndarray | None:
        """The moves of polynomials at corners of patches, see `polynomial_light.moves`; None where there are none."""
        return None if self.light is None else polynomial_light.moves(self.light, self.mesh)

    @cached_property
    def planes(self) -> PlaneFit:
        return PlaneFit(self.patches)

    @property
    def columns(self) -> int:
        """The number of values of a patch."""
        return self.values.shape[1]

    def __call__(self, hits) -> tuple[np.ndarray, np.ndarray]:
        """Return values, (m, n), and patches, (m,): zeros and -1 where a line meets nothing or an absorbing back."""
        patch = self.patch(hits)
        seen = np.flatnonzero(patch >= 0)
        values = np.zeros((len(patch), self.values.shape[1]))
        if self.light is not None:
            u, v = (np.asarray(x, np.float64)[seen] for x in (hits.u, hits.v))
            values[seen] = self._polynomials(self.light, patch[seen], u, v)
        elif self.smooth:
            weight = self._weights(np.asarray(hits.u)[seen], np.asarray(hits.v)[seen], patch[seen])
            corners = self.mesh.polygons[patch[seen]]
            for k in range(4):
                # a corner without weight adds nothing, unknown or not
                share = weight[:, k, None] * self.at_vertices[corners[:, k]]
                values[seen] += np.where(weight[:, k, None] > 0, share, 0.0)
            fitted = seen[self.planes.fits(patch[seen])]
            origin, first, second = (edge[self.patches.face[patch[fitted]]] for edge in self.patches.scene.frames)
            u, v = (np.asarray(x, np.float64)[fitted, None] for x in (hits.u, hits.v))
            values[fitted] = self.planes.at(self.values, patch[fitted], origin + u * first + v * second)
        else:
            values[seen] = self.values[patch[seen]]
        return values, patch

    def _polynomials(self, light: Polynomials, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        if not self.smooth or self.moves is None:
            return np.maximum(light.at(patch, u, v), 0)
        return polynomial_light.moved(light, self.moves, patch, self._weights(u, v, patch), u, v)

    def patch(self, hits) -> np.ndarray:
        """Return the patches that were hit, or -1, (m,) int64."""
        patches, scene = self.patches, self.patches.scene
        face, front = np.asarray(hits.face, np.int64), np.asarray(hits.front, bool)
        hit = np.flatnonzero((face >= 0) & (front | (scene.back[face] == Back.RADIATES)))
        f = face[hit]
        cell = cells.number(
            np.asarray(hits.u)[hit], np.asarray(hits.v)[hit], patches.columns[f], patches.rows[f], scene.is_quad[f]
        )
        result = np.full(len(face), -1, np.int64)
        result[hit] = patches.first[f] + np.where(front[hit], 0, patches.cells_per_face[f]) + cell
        return result

    def _weights(self, u: np.ndarray, v: np.ndarray, patch: np.ndarray) -> np.ndarray:
        """Return the shares of the corners of a patch's polygon at a point of its face, (m, 4)."""
        column, row, inverted = (values[patch] for values in self._place)
        face, back = self.patches.face[patch], self.patches.is_back[patch]
        s, t = u * self.patches.columns[face] - column, v * self.patches.rows[face] - row
        quad = self.patches.scene.is_quad[face]
        a, b = np.clip(s, 0, 1), np.clip(t, 0, 1)
        bilinear = np.stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b], axis=1)
        upright, turned = np.stack([1 - s - t, s, t], axis=1), np.stack([s + t - 1, 1 - s, 1 - t], axis=1)
        triangle = np.clip(np.where(inverted[:, None], turned, upright), 0, None)
        triangle /= triangle.sum(axis=1, keepdims=True)
        weight = np.where(quad[:, None], bilinear, np.column_stack([triangle, np.zeros(len(s))]))
        # polygons of backs have the reverse order
        order = np.where(back[:, None], np.where(quad[:, None], [0, 3, 2, 1], [0, 2, 1, 3]), [0, 1, 2, 3])
        return np.take_along_axis(weight, order, axis=1)

    @cached_property
    def _place(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.patches.place
