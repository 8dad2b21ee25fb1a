"""The triangles of the page: patches, or smoothed values, without what is hidden or cut away."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..image import density_mesh, display_mesh
from ..image.polynomial_light import own_values, vertex_values
from ..image.quantity import Quantity
from .picking import Cut
from .subject import Subject


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles with values at their corners.

    Attributes:
        vertices: (n, 3) float64, m.
        values: (n, n_bands) float64, NaN where unknown.
        corners: (m, 3) int, vertices of each triangle, counterclockwise seen from its patch's side.
        patch: (m,) int, the patch of each.
    """

    vertices: np.ndarray
    values: np.ndarray
    corners: np.ndarray
    patch: np.ndarray

    def take(self, keep: np.ndarray) -> "Triangles":
        """Return some of the triangles (indices or mask), with the vertices that they use."""
        corners = self.corners[keep]
        flags = np.zeros(len(self.vertices), bool)
        flags[corners] = True
        number = np.cumsum(flags) - 1
        return Triangles(self.vertices[flags], self.values[flags], number[corners], self.patch[keep])

    def cut(self, plane: Cut) -> "Triangles":
        """Return what lies on the shown side of a plane; triangles across it are cut, with values interpolated linearly."""
        beyond = plane.beyond(self.vertices)
        out = beyond[self.corners] > 0
        count = out.sum(axis=1)
        across = np.flatnonzero((count > 0) & (count < 3))
        if not len(across):
            return self.take(count == 0)
        # turned so that the corner that is alone on its side of the plane comes first
        alone = np.where(count[across] == 1, np.argmax(out[across], axis=1), np.argmin(out[across], axis=1))
        a, b, c = np.take_along_axis(self.corners[across], (alone[:, None] + np.arange(3)) % 3, axis=1).T
        first, n = len(self.vertices), len(across)
        points, values = [self.vertices], [self.values]
        for other in (b, c):
            share = (beyond[a] / (beyond[a] - beyond[other]))[:, None]
            points.append(self.vertices[a] + share * (self.vertices[other] - self.vertices[a]))
            values.append(self.values[a] + share * (self.values[other] - self.values[a]))
        at_b, at_c = first + np.arange(n), first + n + np.arange(n)
        kept, two = count[across] == 2, count[across] == 1
        corners = [
            self.corners[count == 0],
            np.stack([a, at_b, at_c], axis=1)[kept],
            np.stack([at_b, b, c], axis=1)[two],
            np.stack([at_b, c, at_c], axis=1)[two],
        ]
        patch = [self.patch[count == 0], *(self.patch[across][mask] for mask in (kept, two, two))]
        whole = Triangles(np.concatenate(points), np.concatenate(values), np.concatenate(corners), np.concatenate(patch))
        return whole.take(np.arange(len(whole.corners)))


@dataclass(frozen=True, eq=False)
class Shapes:
    """The meshes of a subject, each made when it is first shown."""

    subject: Subject

    def triangles(self, name: str, quantity: Quantity, band: str | None, *, smooth: bool) -> Triangles:
        """Return the triangles of a quantity, called ``name``, with its values at their corners."""
        solution = self.subject.solution
        if not smooth:
            mesh, owner = self._flat
            corners, patch = self._flat_corners
            return Triangles(mesh.vertices, own_values(self._smooth, owner, quantity), corners, patch)
        fitted = band is None and name in ("radiosity", "irradiance") and quantity.values.shape[1] == len(self._bands)
        if fitted and solution is not None and density_mesh.estimated(solution):
            mesh, values, first = density_mesh.display(solution, name)
            corners, polygon = mesh.triangles()
            return Triangles(mesh.vertices, values, corners, first[polygon])
        corners, patch = self._smooth_corners
        return Triangles(self._smooth.vertices, vertex_values(self.subject.patches, self._smooth, quantity), corners, patch)

    def at(self, subject: Subject) -> "Shapes":
        """Return the meshes of another solution of the same patches."""
        if subject.patches is not self.subject.patches:
            return Shapes(subject)
        made = replace(self, subject=subject)
        made.__dict__.update({name: value for name, value in self.__dict__.items() if name.startswith("_")})
        return made

    @property
    def _bands(self) -> tuple[str, ...]:
        return self.subject.patches.scene.bands

    @cached_property
    def _smooth(self) -> display_mesh.DisplayMesh:
        return display_mesh.build(self.subject.patches)

    @cached_property
    def _smooth_corners(self) -> tuple[np.ndarray, np.ndarray]:
        return self._smooth.triangles()

    @cached_property
    def _flat(self) -> tuple[display_mesh.DisplayMesh, np.ndarray]:
        return self._smooth.flat()

    @cached_property
    def _flat_corners(self) -> tuple[np.ndarray, np.ndarray]:
        return self._flat[0].triangles()
