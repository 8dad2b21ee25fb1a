"""Our own side: independent solves of the same patches."""

from dataclasses import dataclass

import numpy as np

import radiosity as rd

SEEDS = 16


@dataclass(frozen=True, eq=False)
class Runs:
    """Independent solves.

    Attributes:
        irradiance, stated: the standard errors that they stated, (runs, n_patches, n_bands) each.
        rounding: what the books call so, over the emitted power, in the mean of the runs and the worst of the bands: what whole
            lines leave unsent.
    """

    patches: rd.Patches
    irradiance: np.ndarray
    stated: np.ndarray
    rounding: float

    def share(self, receiver: int) -> np.ndarray:
        """(runs,) of all emitted power, what lands on a surface: the view factor from what emits, where nothing reflects."""
        patches = self.patches
        on = patches.surface == receiver
        return self.irradiance[:, on, 0] @ patches.area[on] / (patches.area @ patches.emission[:, 0])

    def net(self, surface: int) -> np.ndarray:
        """(runs,) power that leaves a surface less what it receives, W."""
        patches, on = self.patches, self.patches.surface == surface
        reflected, area = patches.reflectance[on, 0], patches.area[on]
        return area @ patches.emission[on, 0] - self.irradiance[:, on, 0] @ (area * (1 - reflected))

    def absorbed(self, surface: int) -> float:
        """W, in the mean of the runs."""
        patches, on = self.patches, self.patches.surface == surface
        return float(self.irradiance[:, on, 0].mean(axis=0) @ (patches.area[on] * (1 - patches.reflectance[on, 0])))

    def mean(self, rows) -> np.ndarray:
        """(runs,) mean irradiance over some patches (mask or indices)."""
        return self.irradiance[:, rows, 0] @ self.patches.area[rows] / self.patches.area[rows].sum()


def solved(
    patches: rd.Patches, rays: float, *, method="random-walk", seeds: int = SEEDS, replicates: int = 2, first: int = 0
) -> Runs:
    """Solve with ``seeds`` seeds from ``first`` on, ``rays`` lines in all."""
    runs = [rd.solve(patches, method, rays=rays / seeds, replicates=replicates, seed=first + seed) for seed in range(seeds)]
    books = [[abs(book["rounding"]) / book["emitted"] for book in run.books if book["emitted"]] for run in runs]
    values, errors = ([getattr(run, name) for run in runs] for name in ("irradiance", "irradiance_standard_error"))
    return Runs(patches, np.stack(values), np.stack(errors), float(np.mean(books, axis=0).max()))
