"""Cutting the faces that gain most by it: in halves or quarters, triangles in a parallelogram and two triangles."""

from dataclasses import dataclass

import numpy as np

from ..scene.model import Back, Scene
from .model import Patches
from .variation import Variation

BRIGHT = 10.0  # times the mean light of the scene: where light is much brighter, errors count relative to it
LONGEST = 2048.0  # of a patch, over its width: along a lamp, light varies across a strip alone


@dataclass(frozen=True, eq=False)
class Halves:
    """Faces of one cell, and how they may be cut: parallelograms in up to 2 x 2 cells, triangles in four (see `cells_as_faces`).

    Attributes:
        coarse: patches, one cell a face.
        fine: the same, cut.
    """

    coarse: Patches
    fine: Patches

    @staticmethod
    def of(scene: Scene, least: float) -> "Halves":
        """Return the halves of a scene's faces.

        Args:
            least: m², smaller faces are not cut.
        """
        one = np.ones(scene.n_faces, np.int32)
        _, first, second = scene.frames
        length, width = (np.linalg.norm(edge, axis=1) for edge in (first, second))
        cut = scene.area >= least
        columns = 1 + (cut & (~scene.is_quad | (2 * scene.area <= LONGEST * length**2)))
        rows = 1 + (cut & (~scene.is_quad | (2 * scene.area <= LONGEST * width**2)))
        return Halves(Patches(scene, one, one), Patches(scene, columns.astype(np.int32), rows.astype(np.int32)))

    def variation(self, irradiance: np.ndarray, within: tuple[np.ndarray, np.ndarray] | None = None) -> Variation:
        """Return how far light varies over the faces, less noise.

        Args:
            irradiance: (replicates, n_fine, n_bands) of the fine patches.
            within: how far it varies within halves, from `within_halves` (ahead.py); default: not known.
        """
        columns, rows, quad = self.fine.columns, self.fine.rows, self.coarse.scene.is_quad
        along, across, rest, noise = (np.zeros(len(quad)) for _ in range(4))
        four = np.flatnonzero((columns == 2) & (rows == 2))
        cells = self.cells(irradiance, four, 4)
        one, two, both = (0.5 * (cells @ np.array(signs)) / 2 for signs in ((1, -1, 1, -1), (1, 1, -1, -1), (1, -1, -1, 1)))
        (along[four], noise[four]), across[four], rest[four] = square_of(one), square_of(two)[0], square_of(both)[0]
        bent = four[~quad[four]]
        cells = self.cells(irradiance, bent, 4)
        shares = np.array([[0.5, 0.5, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) - 0.25  # a part's mean less that of all
        squares = [square_of(cells @ part) for part in shares]
        along[bent] = across[bent] = 0.0
        rest[bent], noise[bent] = (squares[0][i] / 2 + squares[1][i] / 4 + squares[2][i] / 4 for i in (0, 1))
        for into, some in ((along, (columns == 2) & (rows == 1)), (across, (columns == 1) & (rows == 2))):
            face = np.flatnonzero(some)
            into[face], noise[face] = square_of(0.5 * (self.cells(irradiance, face, 2) @ np.array((1, -1))))
        return Variation(along, across, rest, noise, *(within or (np.zeros(len(quad)),) * 2))

    def weights(self, irradiance: np.ndarray) -> np.ndarray:
        """Return how much squares of errors count on each face, (n_faces,): 1 where it is dark, less where light is bright.

        The inside of a luminaire may be a hundred times brighter than all that it lights. Were all squares equal, it would take
        most of the patches. Where light is m times the mean of the scene, a square counts 1 / (1 + (m / `BRIGHT`)²).

        Args:
            irradiance: (replicates, n_fine, n_bands) of the fine patches.
        """
        fine, n = self.fine, self.coarse.scene.n_faces
        light = (_counting(fine.reflectance) * irradiance.mean(axis=0)).sum(axis=1)
        area = np.bincount(fine.face, fine.area, n)
        power = np.bincount(fine.face, fine.area * light, n)
        return 1 / (1 + (power / area * area.sum() / max(float(power.sum()), 1e-300) / BRIGHT) ** 2)

    def chosen(self, light: Variation, more: int, weights: np.ndarray | float = 1.0) -> tuple[np.ndarray, np.ndarray]:
        """Return columns and rows of the faces, (n_faces,) int32 each: the cuts that gain most for each patch that they add.

        Args:
            more: the largest number of patches that cuts may add.
            weights: (n_faces,), how much a face counts.
        """
        scene, columns, rows = self.coarse.scene, self.fine.columns, self.fine.rows
        sides = np.where(scene.back == Back.RADIATES, 2, 1)
        along = np.maximum(light.along, (light.along + light.within_along) / 3) * (columns == 2)
        across = np.maximum(light.across, (light.across + light.within_across) / 3) * (rows == 2)
        better, first = np.maximum(along, across), along >= across
        second = np.where((columns == 2) & (rows == 2), (np.minimum(along, across) + light.rest) / 2, 0.0)
        second = np.minimum(second, better)  # halves come before quarters
        better, second = (np.where(scene.is_quad, value, light.rest / 2) for value in (better, second))
        cost = np.concatenate([np.where(scene.is_quad, 1, 2) * sides, np.where(scene.is_quad, 2, 0) * sides])
        rate = np.concatenate([better, second]) * np.tile(weights * scene.area / sides, 2)
        order = np.argsort(-rate, kind="stable")
        order = order[(rate[order] > 0) & (cost[order] > 0)]
        order = order[np.cumsum(cost[order]) <= more]
        whole = order[(order >= scene.n_faces) | ~scene.is_quad[order % scene.n_faces]] % scene.n_faces
        half = order[order < scene.n_faces]
        new = np.ones((2, scene.n_faces), np.int32)
        new[0, half], new[1, half] = 1 + first[half], 2 - first[half]
        new[:, whole] = 2
        return new[0], new[1]

    def cells(self, irradiance: np.ndarray, faces: np.ndarray, count: int) -> np.ndarray:
        """Return light that leaves the cells of some faces, (replicates, m, 2 n_bands, cells): fronts, then radiating backs.

        Args:
            irradiance: (replicates, n_fine, n_bands) of the fine patches, or one of the coefficients of its polynomials.
            count: the number of cells of a face.
        """
        rho, first = self.coarse.reflectance, self.fine.first[faces][:, None] + np.arange(count)
        rho = _counting(rho)
        back = self.coarse.scene.back[faces] == Back.RADIATES
        at = self.coarse.first[faces]
        above, below = irradiance[:, first], irradiance[:, first + count * back[:, None]]
        front = above * rho[at][:, None]
        behind = below * (rho[at + back] * back[:, None])[:, None]
        if self.coarse.diffuse_transmittance is not None:
            through = self.coarse.diffuse_transmittance[at][:, None]
            front, behind = front + through * below, behind + through * above
        return np.concatenate([front, behind], axis=3).transpose(0, 1, 3, 2)


def _counting(reflectance: np.ndarray) -> np.ndarray:
    """Return reflectances; ones where all are black, so that what falls on them counts."""
    return reflectance if reflectance.any() else np.ones_like(reflectance)


def square_of(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return squares of means over replicates less noise, and the noise, summed over bands, (m,) each."""
    noise = (values.var(axis=0, ddof=1) / len(values)).sum(axis=1)
    return (values.mean(axis=0) ** 2).sum(axis=1) - noise, noise
