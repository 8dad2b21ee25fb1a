"""Snapshots: the results of a complete stage, in the scene's bands."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..algorithms.base import AbstractBiasedTally, AbstractTally
from ..algorithms.baseline_state import AbstractSolvedState
from ..pieces import pieces
from ..problem.model import Problem
from ..solution.errors import inner_products, margin, mean_and_error, relative_error_of
from ..solution.intervals import FEW, by_luck, least_error, usual_power


@dataclass(eq=False)
class Snapshot:
    """A problem, the state of an algorithm after a stage, and the tally that reads it; ``also`` reads something more of it."""

    problem: Problem
    tally: AbstractTally
    state: Any  # an `AbstractState`, as the tally reads it; None after `settle`
    replicates: int = 1
    also: Callable[["Snapshot"], Any] | None = None

    def settle(self) -> None:
        """Read all results now and drop the state, where that is quick and saves memory.

        As long as a state is held, what the algorithm writes next goes to a copy.
        """
        if self.tally.settles:
            _ = self.quanta, self.lines, self.arrivals, self.irradiance, self.surface_power, self.side_power, self.side_bias
            _ = self.books, self.asked, self.coefficients
            self.state = None
            self.tally.forget()

    @cached_property
    def quanta(self) -> int:
        return self.state.quanta

    @property
    def done(self) -> bool:
        """More quanta would change nothing."""
        return isinstance(self.state, AbstractSolvedState) and self.state.solved is not None and self.state.solved.done

    @cached_property
    def lines(self) -> int:
        return self.tally.lines(self.problem, self.state)

    @cached_property
    def about_lines(self) -> float:
        """About how many lines there were, see `AbstractTally.about_lines`."""
        return self.tally.about_lines(self.problem, self.state)

    @cached_property
    def arrivals(self) -> np.ndarray:
        return self.tally.arrivals(self.problem, self.state)

    @cached_property
    def irradiance(self) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard error, (n_patches, n_bands) each."""
        groups = self.problem.groups
        mean, error = (np.empty((len(self.problem.patches), len(groups.index))) for _ in range(2))
        for group in range(groups.n_groups):
            bands = np.flatnonzero(groups.index == group)
            for part, one, its_error in self._irradiance(group):
                mean[part, bands], error[part, bands] = (x[:, None] * groups.scale[bands] for x in (one, its_error))
        some = any(by_luck(mean[part], error[part]).any() for part in pieces(len(mean)))
        if some and self.tally.counts_hits:
            usual = usual_power(mean, self.arrivals, self.problem.patches.area, self.line)
            error = least_error(mean, error, self.arrivals, self.problem.patches.area, usual, self.replicates)
        return mean, error

    @cached_property
    def coefficients(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Mean and standard error of the coefficients of irradiance after the first, (n_patches, n_bands, K - 1) each.

        None where the basis has one function.
        """
        size, groups, area = self.tally.basis.size, self.problem.groups, self.problem.patches.area
        if size == 1:
            return None
        mean, error = (np.empty((len(area), len(groups.index), size - 1)) for _ in range(2))
        for group in range(groups.n_groups):
            bands = np.flatnonzero(groups.index == group)
            unit = self.tally.irradiance(self.problem, self.state, group)[1]
            for function in range(1, size):
                values = self.tally.moment(self.problem, self.state, group, function)
                one, its_error = mean_and_error(values)
                if isinstance(self.tally, AbstractBiasedTally):
                    its_error = np.hypot(its_error, self.tally.bias_of_moment(self.problem, self.state, group, function))
                found = (x * (unit / area) for x in (one, its_error))
                mean[:, bands, function - 1], error[:, bands, function - 1] = (x[:, None] * groups.scale[bands] for x in found)
        return mean, error

    def moments(self) -> np.ndarray:
        """Return the coefficients of irradiance of each replicate, (replicates, n_patches, n_bands, K) W/m² or lm/m²."""
        groups, area, found = self.problem.groups, self.problem.patches.area, []
        for group in range(groups.n_groups):
            unit = self.tally.irradiance(self.problem, self.state, group)[1] / area
            functions = range(self.tally.basis.size)
            found.append(np.stack([self.tally.moment(self.problem, self.state, group, k) * unit for k in functions], axis=-1))
        return np.stack([found[g] * s for g, s in zip(groups.index, groups.scale, strict=True)], axis=2)

    @cached_property
    def line(self) -> np.ndarray:
        """Power that a line would bring to the mean of replicates, (n_bands,) or (n_patches, n_bands), W or lm.

        See `AbstractTally.line`.
        """
        groups = self.problem.groups
        lines = [np.asarray(self.tally.line(self.problem, self.state, group)) for group in range(groups.n_groups)]
        return np.stack(lines, axis=-1)[..., groups.index] * groups.scale / self.replicates

    @cached_property
    def surface_power(self) -> np.ndarray:
        """Power that surfaces receive and reflect, see `Solution.surface_power`."""
        if self.side_power is not None:
            return self.side_power[:, :, 0::2] + self.side_power[:, :, 1::2]
        patches = self.problem.patches
        return self.sums(patches.surface, len(patches.scene.names))

    @cached_property
    def asked(self) -> Any:
        """The result of ``also``."""
        return None if self.also is None else self.also(self)

    @cached_property
    def side_power(self) -> np.ndarray | None:
        """Power that sides of surfaces receive and reflect, see `Solution.side_power`."""
        patches = self.problem.patches
        if not patches.is_back.any():
            return None
        return self.sums(2 * patches.surface.astype(np.int64) + patches.is_back, 2 * len(patches.scene.names))

    @cached_property
    def side_bias(self) -> np.ndarray | None:
        """The biases of what sides of surfaces receive, see `Solution.side_bias`."""
        patches, tally = self.problem.patches, self.tally
        if not isinstance(tally, AbstractBiasedTally):
            return None
        key = 2 * patches.surface.astype(np.int64) + patches.is_back
        found = self._biases(tally, lambda bias: np.bincount(key, bias, 2 * len(patches.scene.names)))
        return found if np.isfinite(found).all() else None  # unknown with one replicate, as intervals are then

    def sums(self, key: np.ndarray, count: int) -> np.ndarray:
        """Return the power that patches of an equal key receive and reflect, (2, replicates, count, n_bands), W or lm.

        Args:
            key: (n_patches,) int, 0 to count - 1.
        """
        groups, found = self.problem.groups, []
        runs = np.concatenate([[0], np.flatnonzero(key[1:] != key[:-1]) + 1])  # of equal keys: few, since patches follow faces

        def summed(row):
            return np.bincount(key[runs], np.add.reduceat(row, runs, dtype=np.float64), count)

        for group in range(groups.n_groups):
            values, unit = self.tally.irradiance(self.problem, self.state, group)
            sent = groups.scatter.of_rows
            found.append([[summed(row) * unit for row in values], [summed(sent(row, group)) * unit for row in values]])
        return np.stack([np.array(found[g]) * s for g, s in zip(groups.index, groups.scale, strict=True)], axis=-1)

    def _irradiance(self, group: int) -> Iterator[tuple[slice, np.ndarray, np.ndarray]]:
        """Yield mean and standard error of a group, a piece of the patches at a time."""
        values, unit = self.tally.irradiance(self.problem, self.state, group)
        tally = self.tally
        bias = tally.bias(self.problem, self.state, group) if isinstance(tally, AbstractBiasedTally) else None
        for part in pieces(len(self.problem.patches)):
            mean, error = mean_and_error(values[:, part])
            if bias is not None:
                error = np.hypot(error, bias[part])
            factor = unit / self.problem.patches.area[part]
            yield part, mean * factor, error * factor

    def error(self, rows: np.ndarray | slice = slice(None)) -> float:
        """Return the error of some patches, see `Solution.error`."""
        patches = self.problem.patches
        return relative_error_of(patches.scatter, *self.irradiance, patches.area, rows)

    def judged(self, rows: np.ndarray | slice = slice(None)) -> bool:
        """Return whether the error of some patches is known well enough to stop there: it comes from `FEW` lines or more.

        The relative variance of an error known from n lines is proportional to 1 / n. So the sum of squared errors s_i of patches
        with n_i hits is known as well as that of one patch with (sum s)^2 / sum (s^2 / n) hits. Where fewer lines from the lights
        would bring as much power, these are counted instead. The least error, where there is no hit, counts as one line.
        """
        patches, (mean, error) = self.problem.patches, self.irradiance
        area, rho, error = patches.area[rows, None], patches.scatter.albedo[rows], error[rows]
        power, line = mean[rows] * area, np.broadcast_to(self.line, mean.shape)[rows]
        lines = np.minimum(np.divide(power, line, out=np.full(power.shape, np.inf), where=line > 0), self.arrivals[rows, None])
        square = area * ((rho if rho.any() else 1.0) * error) ** 2
        known = square.sum(axis=0) > 0
        share = square[:, known] / square[:, known].sum(axis=0)
        told = np.where(lines > 0, lines, 1.0)[:, known]
        return bool(known.any() and (FEW * (share**2 / told).sum(axis=0) <= 1 + 1e-9).all())

    def error_of_mean(self, rows: np.ndarray | slice, surfaces: np.ndarray) -> float:
        """Return the relative standard error of the mean irradiance over some surfaces, the largest of the bands.

        It is NaN where there are no hits.

        Args:
            rows, surfaces: the surfaces, once as patches and once as surfaces.
        """
        power = self.surface_power[0][:, surfaces].sum(axis=1)  # (replicates, n_bands)
        mean, error = mean_and_error(power)
        error = np.hypot(error, self._bias_of_sum(rows))
        lit, blind = mean > 0, (mean <= 0) & (error > 0)
        return float((error[lit] / mean[lit]).max()) if lit.any() and not blind.any() else float("nan")

    def sum_over(self, share: np.ndarray, *, radiosity: bool) -> np.ndarray:
        """Return a weighted sum over patches in each replicate, (replicates, n_bands) W/m² or lm/m².

        Args:
            share: (n_patches,) weights.
            radiosity: the sum of radiosity, emission included; False: of irradiance.
        """
        groups, found = self.problem.groups, []
        weights = share / self.problem.patches.area
        for group in range(groups.n_groups):
            values, unit = self.tally.irradiance(self.problem, self.state, group)
            rows = [groups.scatter.of_rows(row, group) if radiosity else row for row in values]
            emitted = float(groups.emission[:, group] @ share) if radiosity else 0.0
            found.append(np.array([float(row @ weights) for row in rows]) * unit + emitted)
        return np.stack([found[g] * s for g, s in zip(groups.index, groups.scale, strict=True)], axis=-1)

    def error_of_sum(self, share: np.ndarray, *, radiosity: bool) -> float:
        """Return the relative standard error of a weighted sum (see `sum_over`), the largest of the bands; NaN where unknown."""
        mean, error = mean_and_error(self.sum_over(share, radiosity=radiosity))
        lit = mean > 0
        return float((error[lit] / mean[lit]).max()) if lit.any() else float("nan")

    def judged_sum(self, share: np.ndarray) -> bool:
        """Return whether a weighted sum comes from `FEW` hits or more in each replicate."""
        hits, power = self.arrivals, share[:, None] * self.irradiance[0]
        part = power / np.maximum(power.sum(axis=0), 1e-300)
        return bool(power.any() and (FEW * self.replicates * (part**2 / np.maximum(hits, 1)[:, None]).sum(axis=0) <= 1).all())

    def judged_mean(self, rows: np.ndarray | slice) -> bool:
        """Return whether some patches have `FEW` hits or more, counted as in `judged`."""
        patches, mean = self.problem.patches, self.irradiance[0]
        power, line = (mean * patches.area[:, None])[rows], np.broadcast_to(self.line, mean.shape)[rows]
        lines = np.minimum(np.divide(power, line, out=np.full(power.shape, np.inf), where=line > 0), self.arrivals[rows, None])
        lit = power.sum(axis=0) > 0
        return bool(lit.any() and (lines[:, lit].sum(axis=0) >= FEW).all())

    def _bias_of_sum(self, rows: np.ndarray | slice) -> np.ndarray:
        """Return a bound of the sum of the biases of some patches, (n_bands,), W or lm; 0 where the tally has no biases."""
        if not isinstance(self.tally, AbstractBiasedTally):
            return np.zeros(len(self.problem.groups.index))
        return self._biases(self.tally, lambda bias: bias[rows].sum())

    def _biases(self, tally: AbstractBiasedTally, summed: Callable) -> np.ndarray:
        """Return sums of the sizes of biases of patches, (..., n_bands), W or lm."""
        groups, found = self.problem.groups, []
        for group in range(groups.n_groups):
            _, unit = tally.irradiance(self.problem, self.state, group)
            found.append(summed(np.abs(tally.bias_of_sums(self.problem, self.state, group))) * unit)
        return np.stack(found, axis=-1)[..., groups.index] * groups.scale

    def margin(self, rows: np.ndarray | slice = slice(None)) -> float:
        """Return how many times `error` the true one may be, see `solution.errors.margin`; the largest of the groups of bands."""
        area, groups, found = self.problem.patches.area[rows], self.problem.groups, []
        for group in range(groups.n_groups):
            values, _ = self.tally.irradiance(self.problem, self.state, group)
            rho = groups.scatter.albedo[rows, group]
            weight = (rho if rho.any() else np.ones(len(rho))) / np.sqrt(area)
            found.append(margin(inner_products(np.asarray(values)[:, rows], weight), len(values)))
        return max(found)

    @cached_property
    def books(self) -> tuple[dict, ...]:
        """The energy balance of each band, see `Solution.books`."""
        groups = self.problem.groups
        books = [self.tally.books(self.problem, self.state, group) for group in range(groups.n_groups)]
        return tuple(
            {name: value if name == "closes" else value * scale for name, value in books[group].items()}
            for group, scale in zip(groups.index, groups.scale, strict=True)
        )
