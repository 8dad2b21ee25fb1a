"""The discretisation error of a solution, by comparison with one on finer patches."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .csv_rows import write_rows
from .model import Solution
from .percent import UNKNOWN, percent
from .within import apart, noise

MOST_ROWS = 24
ORDER = 1.0  # order of the change of patch means in the patch size, see docs/errors.md


@dataclass(frozen=True, eq=False)
class RefineCheck:
    """Two solutions, on patches and on patches cut into four; `radiosity.refine_check` returns one.

    Attributes:
        coarse: the solution asked for.
        fine: the solution on patches cut into four.
        parent: (n_fine,) the coarse patch of each fine one.
        fine_error: (n_patches, n_bands) standard error of the fine solution's mean radiosity over each coarse patch.

    Example:
        >>> check = rd.refine_check(rd.subdivide(rd.load_scene("room"), cells=1), rays=5_000)
        >>> first = check.table()[0]
        >>> first["surface"], 0 < first["sampling"] < 0.2
        ('the whole scene', True)
    """

    coarse: Solution
    fine: Solution
    parent: np.ndarray
    fine_error: np.ndarray

    @cached_property
    def fine_mean(self) -> np.ndarray:
        """The mean radiosity of the fine solution over each coarse patch, (n_patches, n_bands)."""
        return self._mean(self.fine.radiosity)

    @cached_property
    def change(self) -> np.ndarray:
        """The change of a patch's mean radiosity when all patches are cut into four, with noise, (n_patches, n_bands)."""
        return self.fine_mean - self.coarse.radiosity

    @cached_property
    def change_error(self) -> np.ndarray:
        """The standard error of `change`, from the replicates of both runs, (n_patches, n_bands)."""
        return np.hypot(self.coarse.standard_error, self.fine_error)

    @cached_property
    def square_of_means(self) -> np.ndarray:
        """The estimated square of the discretisation error of a patch's mean, (n_patches, n_bands).

        It is the square of the change without its noise, extrapolated to ever smaller patches. It may be negative where noise is
        larger than the change.
        """
        return (self.change**2 - self.change_error**2) / (1 - 2.0**-ORDER) ** 2

    @cached_property
    def square_within(self) -> np.ndarray:
        """The estimated mean square of B(x) less its mean over the patch, which a constant leaves out, (n_patches, n_bands).

        The four children show three quarters of it, where B is linear. What polynomials of degree d leave out is B(x) less the
        polynomial; the children show 1 - 4^-(d + 1) of it.
        """
        if self.coarse.basis.size > 1:
            return self._left_out - self.change**2 + self.change_error**2
        apart = self.fine.radiosity - self.fine_mean[self.parent]
        noise = self._mean(self.fine.standard_error**2) - self.fine_error**2
        return (self._mean(apart**2) - noise) * (4 / 3)

    @cached_property
    def _left_out(self) -> np.ndarray:
        """The estimated mean square of B(x) less the polynomial of its patch, mean and all, (n_patches, n_bands)."""
        square = self._mean(apart(self.coarse, self.fine, self.parent) - noise(self.fine)) - noise(self.coarse)
        return square / (1 - 4.0 ** -(self.coarse.basis.degree + 1))

    def _mean(self, values: np.ndarray) -> np.ndarray:
        area, n = self.fine.patches.area, len(self.coarse.patches)
        sums = [np.bincount(self.parent, area * column, n) for column in values.T]
        return np.stack(sums, axis=1) / self.coarse.patches.area[:, None]

    def table(self) -> list[dict]:
        """The table of errors: a row for the whole scene and one for each surface.

        Errors are RMS over the patches' area, relative to the RMS of the light reflected (of the radiosity, where nothing is
        reflected), the largest of the bands.

        Keys: surface, patches, sampling (standard error of the coarse solution), discretisation (of patch means), within (what
        constants leave out within patches), change (of the mean radiosity over the surface, signed, of the band that it is
        largest in).
        """
        patches = self.coarse.patches
        names = ["the whole scene", *patches.scene.names]
        inside = ~self.coarse.sides.left_out  # as in tables of surfaces
        rows = [inside, *(inside & (patches.surface == i) for i in range(len(patches.scene.names)))]
        return [{"surface": name, **self._row(here)} for name, here in zip(names, rows, strict=True) if here.any()]

    def _row(self, here: np.ndarray) -> dict:
        patches, area = self.coarse.patches, self.coarse.patches.area[here]
        size = np.sqrt(area @ (self.coarse.radiosity - patches.emission)[here] ** 2)
        usual = np.sqrt(area @ self.coarse.radiosity[here] ** 2)
        black = ~(patches.scatter.albedo[here] > 0).any(axis=0)  # other patches reflect light of unknown size
        size = np.where(size > 0, size, np.where((usual > 0) & black, usual, np.nan))

        def relative(square: np.ndarray) -> float:
            return _largest(np.sqrt(np.maximum(area @ square[here], 0)) / size)

        moved = (area @ self.change[here]) / (np.sqrt(area.sum()) * size)
        return {
            "patches": int(here.sum()),
            "sampling": relative(self.coarse.standard_error**2),
            "discretisation": relative(self.square_of_means),
            "within": relative(self.square_within),
            "change": float(moved[np.nanargmax(np.abs(moved))]) if np.isfinite(moved).any() else float("nan"),
        }

    def report(self) -> str:
        """Return the table in plain text, the surfaces with the largest errors first."""
        first, *rows = self.table()
        rows.sort(key=lambda row: -max(row["sampling"], row["discretisation"]))
        shown = [first, *rows[:MOST_ROWS]]
        width = max(len(row["surface"][:32]) for row in shown)
        head = f"{'errors of the reflected light':<{width}} {'sampling':>9} {'patch means':>12} {'within':>8} {'mean moves':>11}"
        lines = [f"refine check: {len(self.fine.patches)} patches against {len(self.coarse.patches)}", head]
        for row in shown:
            lines.append(
                f"{row['surface'][:32]:<{max(width, 29)}} {percent(row['sampling']):>9} {percent(row['discretisation']):>12} "
                f"{percent(row['within']):>8} {percent(row['change'], '+.2%'):>11}"
            )
        if len(rows) > MOST_ROWS:
            lines.append(f"... and {len(rows) - MOST_ROWS} more surfaces (export a .csv for all)")
        if any(f" {UNKNOWN} " in f"{line} " for line in lines[2:]):
            lines.append(f"{UNKNOWN}: unknown, since nothing is reflected there, or no line hit it")
        return "\n".join(lines)

    def export(self, path) -> None:
        """Write the table as CSV.

        Raises:
            OutputError: the file cannot be written.
        """
        write_rows(self.table(), path)


def _largest(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else float("nan")
