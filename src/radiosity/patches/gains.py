"""What cutting a face gains: how far the light of its cells differs, from a run on cells of cells."""

from dataclasses import dataclass

import numpy as np

from ..scene.model import Back, Scene
from .model import Patches

NOISE = 1.5  # times its noise: what the light of two cells differs by beyond this counts
LONGEST = 8.0  # of a patch, over its width


@dataclass(frozen=True, eq=False)
class Halves:
    """How faces of one cell are cut, to see what that gains: parallelograms in up to 2 x 2 cells, triangles in four.

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
        length = [np.linalg.norm(edge, axis=1) for edge in (first, second)]
        height = [scene.area / edge for edge in length]  # of a parallelogram, across each edge
        cut = scene.area >= least
        columns = 1 + (cut & (~scene.is_quad | (2 * height[0] <= LONGEST * length[0])))
        rows = 1 + (cut & (~scene.is_quad | (2 * height[1] <= LONGEST * length[1])))
        return Halves(Patches(scene, one, one), Patches(scene, columns.astype(np.int32), rows.astype(np.int32)))

    def chosen(self, irradiance: np.ndarray, more: int) -> tuple[np.ndarray, np.ndarray]:
        """Return columns and rows of the faces, (n_faces,) int32 each: the cuts that gain most for each patch that they add.

        Args:
            irradiance: (replicates, n_fine, n_bands) of the fine patches.
            more: the largest number of patches that cuts may add.
        """
        steps = self._steps(irradiance)
        order = np.argsort(-steps.rate, kind="stable")
        order = order[steps.rate[order] > 0]
        order = order[np.cumsum(steps.cost[order]) <= more]
        columns, rows = (np.ones(self.coarse.scene.n_faces, np.int32) for _ in range(2))
        np.maximum.at(columns, steps.face[order], steps.columns[order])
        np.maximum.at(rows, steps.face[order], steps.rows[order])
        return columns, rows

    def _steps(self, irradiance: np.ndarray) -> "Steps":
        """Return all cuts: each face's better one first, then what the other one adds to it."""
        scene, columns, rows = self.coarse.scene, self.fine.columns, self.fine.rows
        sides = np.where(scene.back == Back.RADIATES, 2, 1)
        four = np.flatnonzero((columns == 2) & (rows == 2))
        parts = []
        along, across, both = (np.zeros(scene.n_faces) for _ in range(3))
        cells = self._cells(irradiance, four, 4)
        quad = scene.is_quad[four]
        means = [cells[:, :, [0, 2]].mean(axis=2) - cells[:, :, [1, 3]].mean(axis=2)]
        means += [cells[:, :, :2].mean(axis=2) - cells[:, :, 2:].mean(axis=2)]
        along[four], across[four] = (self._square(0.5 * mean) for mean in means)
        both[four] = sum(self._square(cells[:, :, i] - cells.mean(axis=2)) for i in range(4)) / 4
        for some, into in (
            (np.flatnonzero((columns == 2) & (rows == 1)), along),
            (np.flatnonzero((columns == 1) & (rows == 2)), across),
        ):
            cells = self._cells(irradiance, some, 2)
            into[some] = self._square(0.5 * (cells[:, :, 0] - cells[:, :, 1]))
        area = scene.area
        triangle, square = four[~quad], four[quad]
        parts.append(
            Steps(
                triangle,
                area[triangle] * both[triangle] / 3,
                3 * sides[triangle],
                np.full(len(triangle), 2),
                np.full(len(triangle), 2),
            )
        )
        split = np.flatnonzero(scene.is_quad & (columns * rows > 1))
        better, first = np.maximum(along, across)[split], along[split] >= across[split]
        parts.append(Steps(split, area[split] * better, sides[split], 1 + first, 1 + ~first))
        rest = np.maximum(both - np.maximum(along, across), 0)[square] * (np.maximum(along, across)[square] > 0)
        second = np.minimum(rest / 2, np.maximum(along, across)[square])
        parts.append(Steps(square, area[square] * second, 2 * sides[square], np.full(len(square), 2), np.full(len(square), 2)))
        every = Steps(*(np.concatenate([getattr(part, name) for part in parts]) for name in Steps.__dataclass_fields__))
        every.rate[:] = every.rate / sides[every.face]
        return every

    def _cells(self, irradiance: np.ndarray, faces: np.ndarray, count: int) -> np.ndarray:
        """Return reflected light of cells of some faces, (replicates, m, cells, 2 n_bands): fronts, then radiating backs."""
        rho, number = self.coarse.reflectance, self.fine.first[faces][:, None] + np.arange(count)
        rho = rho if rho.any() else np.ones_like(rho)
        back = self.coarse.scene.back[faces] == Back.RADIATES
        above, below = irradiance[:, number], irradiance[:, np.where(back[:, None], number + count, number)]
        front = above * rho[self.coarse.first[faces]][:, None]
        behind = below * (rho[self.coarse.first[faces] + back] * back[:, None])[:, None]
        if self.coarse.diffuse_transmittance is not None:
            through = self.coarse.diffuse_transmittance[self.coarse.first[faces]][:, None]
            front, behind = front + through * below, behind + through * above
        return np.concatenate([front, behind], axis=3)

    def _square(self, values: np.ndarray) -> np.ndarray:
        """Return squares of the mean over replicates, summed over bands, less noise; (m,)."""
        mean = values.mean(axis=0)
        noise = values.var(axis=0, ddof=1) / len(values)
        return np.maximum((mean**2 - NOISE * noise).sum(axis=1), 0)


@dataclass(frozen=True, eq=False)
class Steps:
    """Cuts of faces: what each gains for each patch that it adds, how many it adds, and the columns and rows that it makes."""

    face: np.ndarray
    rate: np.ndarray
    cost: np.ndarray
    columns: np.ndarray
    rows: np.ndarray
