"""Patches: the radiating sides of congruent cells of the scene's faces."""

import hashlib
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ..scene.model import Back, Scene
from . import cells
from .paint_means import cell_means
from .scatter import Scatter

MOST = float(np.nextafter(1.0, 0.0))  # a reflectance


@dataclass(frozen=True, eq=False)
class Patches:
    """The patches of a scene, ordered by face, side (front, then a radiating back), cell. `subdivide` makes them.

    Attributes:
        scene: the scene whose faces are divided.
        columns, rows: (n_faces,) int32, cells along the face's first and second edge (equal for triangles).
        own_reflectance, own_emission: (n_patches, n_bands) float64, where patches have values of their own in place of the
            scene's, see `patches.relit.relit`; else None.
        pane_of: the patches whose solid part these are, see `solid`; else None.

    Example:
        >>> patches = rd.subdivide(rd.load_scene("room"), cells=2)
        >>> len(patches), patches.area.shape, patches.scene.names[patches.surface[0]]
        (72, (72,), 'south wall')
    """

    scene: Scene
    columns: np.ndarray
    rows: np.ndarray
    own_reflectance: np.ndarray | None = None
    own_emission: np.ndarray | None = None
    pane_of: "Patches | None" = field(default=None, repr=False)

    def __len__(self) -> int:
        return int(self.first[-1])

    @property
    def sizes(self) -> np.ndarray:
        """The square root of the mean area of the cells of each face, (n_faces,) metres."""
        cells_of = self.columns * self.rows * np.where(self.scene.is_quad, 1, 0.5)
        return np.sqrt(self.scene.area / np.maximum(cells_of, 0.5))

    @property
    def cut_hash(self) -> str:
        """SHA-256 of the way in which the scene is cut."""
        return self._cut().hexdigest()

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the way in which the scene is cut, and of values that patches have of their own."""
        digest = self._cut()
        for name in ("own_reflectance", "own_emission"):
            own = getattr(self, name)
            if own is not None:
                digest.update(f"{name}{own.shape}".encode() + own.tobytes())
        return digest.hexdigest()

    def _cut(self):
        return hashlib.sha256(self.columns.tobytes() + self.rows.tobytes())

    @cached_property
    def solid(self) -> "Patches":
        """The patches as the equation has them; these patches themselves where no face is a pane.

        A pane of transmittance t is like a screen with tiny holes, t of its area. The solid part has 1 - t of the area, and what
        the pane reflects and emits comes from there: reflectance and exitance are those of the whole pane over 1 - t. Lines end
        on it as on any other patch. The irradiance is that of the whole pane.
        """
        return self if self.scene.transmittance is None or self.pane_of is not None else replace(self, pane_of=self)

    @property
    def whole(self) -> "Patches":
        """The patches with whole panes, see `solid`."""
        return self if self.pane_of is None else self.pane_of

    @cached_property
    def transmittance(self) -> np.ndarray:
        """The share of lines that goes straight on through each patch, (n_patches,) float64; 0 where it is no pane."""
        return np.zeros(len(self)) if self.scene.transmittance is None else self.scene.transmittance[self.face]

    @cached_property
    def cells_per_face(self) -> np.ndarray:
        """Cells of one side of each face, (n_faces,) int64."""
        return cells.count(self.columns, self.rows)

    @cached_property
    def first(self) -> np.ndarray:
        """The first patch of each face, and the number of patches, (n_faces + 1,) int64; a radiating back follows the front."""
        sides = np.where(self.scene.back == Back.RADIATES, 2, 1)
        return np.concatenate([[0], np.cumsum(self.cells_per_face * sides)])

    @cached_property
    def face(self) -> np.ndarray:
        """The face of each patch, (n_patches,) int32."""
        return np.repeat(np.arange(self.scene.n_faces, dtype=np.int32), np.diff(self.first))

    @cached_property
    def is_back(self) -> np.ndarray:
        """Which patches are on backs, (n_patches,) bool."""
        fronts = np.stack([self.cells_per_face, np.diff(self.first) - self.cells_per_face], axis=1)
        return np.repeat(np.tile([False, True], len(fronts)), fronts.ravel())

    @property
    def place(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Column, row and inverted flag of each patch's cell, (n_patches,) each."""
        return self.places(slice(0, len(self)))

    def places(self, part: slice) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return `place` of a slice of the patches."""
        face = self.face[part]
        cell = np.arange(part.start, part.stop) - self.first[face] - np.where(self.is_back[part], self.cells_per_face[face], 0)
        return cells.place(cell, self.columns[face], self.scene.is_quad[face])

    @property
    def corners(self) -> np.ndarray:
        """Corners, (n_patches, 4, 3) float64, metres, counterclockwise seen from the patch's own side; a triangle repeats its
        last one."""
        face = self.face
        uv = cells.corners(*self.place, self.columns[face], self.rows[face], self.scene.is_quad[face])
        origin, first, second = (edge[face][:, None, :] for edge in self.scene.frames)
        points = origin + uv[:, :, :1] * first + uv[:, :, 1:] * second
        back = self.is_back
        turned = np.where(self.scene.is_quad[face[back], None], [0, 3, 2, 1], [0, 2, 1, 1])
        points[back] = np.take_along_axis(points[back], turned[:, :, None], axis=1)
        return points

    @cached_property
    def area(self) -> np.ndarray:
        """Areas, (n_patches,) float64, m²."""
        if self.pane_of is not None:
            return self.pane_of.area * (1 - self.transmittance)
        return (self.scene.area / self.cells_per_face)[self.face]

    @cached_property
    def normal(self) -> np.ndarray:
        """Normals of unit length, (n_patches, 3) float64, which point to the radiating side."""
        return self.normals(slice(0, len(self)))

    def normals(self, part: slice) -> np.ndarray:
        """Return `normal` of a slice of the patches."""
        return self.scene.normal[self.face[part]] * np.where(self.is_back[part], -1.0, 1.0)[:, None]

    @cached_property
    def centroid(self) -> np.ndarray:
        """Centroids, (n_patches, 3) float64, metres."""
        return self.centroids(slice(0, len(self)))

    def centroids(self, part: slice) -> np.ndarray:
        """Return `centroid` of a slice of the patches."""
        column, row, inverted = self.places(part)
        face = self.face[part]
        middle = np.where(self.scene.is_quad[face], 0.5, np.where(inverted, 2 / 3, 1 / 3))
        u, v = (column + middle) / self.columns[face], (row + middle) / self.rows[face]
        origin, first, second = (edge[face] for edge in self.scene.frames)
        return origin + u[:, None] * first + v[:, None] * second

    @cached_property
    def surface(self) -> np.ndarray:
        """The surface of each patch, (n_patches,) int32, an index into ``scene.names``."""
        return self.scene.surface[self.face]

    @cached_property
    def reflectance(self) -> np.ndarray:
        """Reflectances, (n_patches, n_bands) float64."""
        if self.pane_of is not None:
            return np.minimum(self._over_solid(self.pane_of.reflectance), MOST)
        if self.own_reflectance is not None:
            return self.own_reflectance
        return self._of_side(self.scene.reflectance, self.scene.back_reflectance, self.scene.reflectance_paint)

    @cached_property
    def emission(self) -> np.ndarray:
        """Self-emitted radiosity, (n_patches, n_bands) float64, W/m² or lm/m²."""
        if self.pane_of is not None:
            return self._over_solid(self.pane_of.emission)
        if self.own_emission is not None:
            return self.own_emission
        return self._of_side(self.scene.emission, self.scene.back_emission, self.scene.emission_paint)

    def reflectances(self, part: slice) -> np.ndarray:
        """Return `reflectance` of a slice of the patches; what is not known yet is not kept."""
        scene = self.scene
        if "reflectance" in self.__dict__ or self.pane_of or self.own_reflectance is not None or scene.reflectance_paint:
            return self.reflectance[part]
        return self._of_sides(scene.reflectance, scene.back_reflectance, part)

    def emissions(self, part: slice) -> np.ndarray:
        """Return `emission` of a slice of the patches; what is not known yet is not kept."""
        scene = self.scene
        if "emission" in self.__dict__ or self.pane_of or self.own_emission is not None or scene.emission_paint:
            return self.emission[part]
        return self._of_sides(scene.emission, scene.back_emission, part)

    @cached_property
    def diffuse_transmittance(self) -> np.ndarray | None:
        """The share of what falls on a patch that leaves its other side in all directions, (n_patches, n_bands) float64.

        It is None where the scene has no diffusing panes.
        """
        if self.scene.diffuse_transmittance is None:
            return None
        if self.pane_of is None:
            return self.scene.diffuse_transmittance[self.face]
        whole = self.pane_of.diffuse_transmittance
        assert whole is not None
        return np.clip(self._over_solid(whole), 0, MOST - self.reflectance)

    @cached_property
    def other_side(self) -> np.ndarray:
        """The patch on the other side of each patch's cell, (n_patches,) int64; the patch itself where that does not radiate."""
        cells = np.where(self.scene.back == Back.RADIATES, self.cells_per_face, 0)[self.face]
        return np.arange(len(self)) + np.where(self.is_back, -cells, cells)

    @cached_property
    def scatter(self) -> Scatter:
        """What patches send on of the light that they receive."""
        through = self.diffuse_transmittance
        return Scatter(self.reflectance, through, None if through is None else self.other_side)

    def _over_solid(self, values: np.ndarray) -> np.ndarray:
        return values / (1 - self.transmittance)[:, None]

    def _of_sides(self, front: np.ndarray, back: np.ndarray, part: slice) -> np.ndarray:
        face = self.face[part]
        return np.where(self.is_back[part, None], back[face], front[face])

    def _of_side(self, front, back, paint) -> np.ndarray:
        if paint is None:
            return self._of_sides(front, back, slice(0, len(self)))
        scene = self.scene
        result = np.empty((len(self), front.shape[1]))
        radiates = scene.back == Back.RADIATES
        own = radiates & (back != front).any(axis=1)
        means = cell_means(paint, front, self.columns, self.rows, scene.is_quad)
        result[~self.is_back] = means
        twice = np.repeat(radiates & ~own, self.cells_per_face)
        result[self.is_back & ~own[self.face]] = means[twice]
        if own.any():
            rows = np.flatnonzero(own)
            means = cell_means(paint.take(rows), back[rows], self.columns[rows], self.rows[rows], scene.is_quad[rows])
            result[self.is_back & own[self.face]] = means
        return np.minimum(result, np.where(paint.painted, paint.limit, np.inf)[self.face, None])
