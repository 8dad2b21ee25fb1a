"""A complete stage: what its state means for the scene's bands."""

from dataclasses import dataclass

import numpy as np

from ..solution.errors import mean_and_error, relative_error
from .problem import Problem
from .process import AbstractBiasedTally, AbstractTally, State


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The problem, the state of a process and how it is read."""

    problem: Problem
    tally: AbstractTally
    state: State

    @property
    def quanta(self) -> int:
        return int(self.state["quanta"])

    @property
    def done(self) -> bool:
        """More quanta would change nothing."""
        return bool(self.state.get("done", False))

    @property
    def lines(self) -> int:
        return self.tally.lines(self.problem, self.state)

    @property
    def arrivals(self) -> np.ndarray:
        return self.tally.arrivals(self.problem, self.state)

    def irradiance(self) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard error, (n_patches, n_bands) each."""
        groups = self.problem.groups
        columns = [self._irradiance(group) for group in range(groups.n_groups)]
        scaled = [[x * s for x in columns[g]] for g, s in zip(groups.index, groups.scale, strict=True)]
        mean, error = (np.stack(column, axis=1) for column in zip(*scaled, strict=True))
        return mean, error

    def _irradiance(self, group: int) -> tuple[np.ndarray, np.ndarray]:
        values, unit = self.tally.irradiance(self.problem, self.state, group)
        mean, error = mean_and_error(values)
        if isinstance(self.tally, AbstractBiasedTally):
            error = np.hypot(error, self.tally.bias(self.problem, self.state, group))
        area = self.problem.patches.area
        return mean * (unit / area), error * (unit / area)

    def error(self) -> float:
        """See `Solution.error`."""
        irradiance, error = self.irradiance()
        rho, area = self.problem.patches.reflectance, self.problem.patches.area
        return relative_error(rho * irradiance, rho * error, area, (irradiance, error))

    def books(self) -> tuple[dict, ...]:
        """See `Solution.books`."""
        groups = self.problem.groups
        books = [self.tally.books(self.problem, self.state, group) for group in range(groups.n_groups)]
        return tuple(
            {name: value if name == "closes" else value * scale for name, value in books[group].items()}
            for group, scale in zip(groups.index, groups.scale, strict=True)
        )
