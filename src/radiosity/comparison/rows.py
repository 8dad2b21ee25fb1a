"""Differences of means over surfaces and sides."""

from dataclasses import dataclass

import numpy as np

from ..solution.means import of_rows, row_powers
from ..solution.model import Solution
from .pairing import row_areas
from .significance import Test, chi_square, welch


@dataclass(frozen=True, eq=False)
class Rows:
    """Means over surfaces and sides by both solutions, and the test of their differences.

    Attributes:
        surface, side: (k,) names.
        area: (k,) m², of the first solution.
        values: (2, k, n_bands) means.
        errors: (2, k, n_bands) standard errors; NaN where unknown, 0 of a reference.
        test: of each difference, (k, n_bands); NaN where few lines hit.
        chi: chi square over the number of differences; NaN where unknown.
        independent: the number of independent differences that count.
        chance: the probability of a chi square as large by chance alone; NaN where unknown.
    """

    surface: tuple[str, ...]
    side: tuple[str, ...]
    area: np.ndarray
    values: np.ndarray
    errors: np.ndarray
    test: Test
    chi: float
    independent: float
    chance: float

    @property
    def difference(self) -> np.ndarray:
        """The first mean less the second, (k, n_bands)."""
        return self.values[0] - self.values[1]


def rows_of(a: Solution, b: Solution, rows, quantity: str, replicates, least: int) -> Rows:
    """Compare rows of the tables of two solutions.

    Args:
        rows: (k,) int of each solution.
        quantity: "irradiance" or "radiosity".
        replicates: two numbers; None for a reference.
        least: hits that a row needs in both solutions to be tested.
    """
    means = np.stack([_means(one, quantity)[row] for one, row in zip((a, b), rows, strict=True)])
    errors = np.stack(
        [
            np.zeros(means.shape[1:]) if count is None else of_rows(one, 0.95, quantity).error[row]
            for one, row, count in zip((a, b), rows, replicates, strict=True)
        ]
    )
    spreads = [
        _spread(one, quantity)[:, row].reshape(count, -1)
        for one, row, count in zip((a, b), rows, replicates, strict=True)
        if count is not None and count > 1 and one.surface_power is not None
    ]
    difference = means[0] - means[1]
    together = np.sqrt((errors**2).sum(axis=0))
    needed = sum(count is not None for count in replicates)
    enough = np.all([_hits(one)[row] >= least for one, row in zip((a, b), rows, strict=True)], axis=0)
    test = welch(difference, errors, replicates)
    test = Test(*(np.where(enough[:, None], value, np.nan) for value in (test.score, test.chance)))
    chi = chi_square(test.score.ravel(), together.ravel(), spreads) if len(spreads) == needed > 0 else (np.nan,) * 3
    names, sides = a.patches.scene.names, a.sides
    return Rows(
        tuple(names[i] for i in sides.surface[rows[0]]),
        tuple(sides.side[i] for i in rows[0]),
        row_areas(a)[rows[0]],
        means,
        errors,
        test,
        *chi,
    )


def _hits(solution: Solution) -> np.ndarray:
    """Hits of the rows, (n_rows,); without bound where the method counts none."""
    row, n = solution.sides.row, len(solution.sides.surface)
    if solution.by_baseline:
        return np.full(n, np.inf)
    return np.bincount(row[row >= 0], solution.arrivals[row >= 0], n)


def _means(solution: Solution, quantity: str) -> np.ndarray:
    """Area means of the rows, (n_rows, n_bands)."""
    row, some = solution.sides.row, solution.sides.row >= 0
    patches = solution.patches.solid if quantity == "irradiance" else solution.patches
    weight, values = patches.area[some], getattr(solution, quantity)[some]
    n = len(solution.sides.surface)
    total = np.stack([np.bincount(row[some], weight * band, n) for band in values.T], axis=1)
    area = np.bincount(row[some], weight, n)
    return total / np.where(area > 0, area, 1)[:, None]


def _spread(solution: Solution, quantity: str) -> np.ndarray:
    """Area means of the rows in each replicate, without emission, (replicates, n_rows, n_bands)."""
    power = row_powers(solution)
    assert power is not None
    row, some = solution.sides.row, solution.sides.row >= 0
    patches = solution.patches.solid if quantity == "irradiance" else solution.patches
    area = np.bincount(row[some], patches.area[some], len(solution.sides.surface))
    return power[0 if quantity == "irradiance" else 1] / np.where(area > 0, area, 1)[:, None]
