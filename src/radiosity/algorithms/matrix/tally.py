"""What counted lines mean: form factors, and the solution of the equation with them."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ...factors.counts import WORD, split
from ...factors.model import Factors
from ...factors.solve import irradiance, of_both_ways, of_own_light, of_rows
from ...problem.model import Problem
from ...solution.books import by_difference
from ...tally.unmet import bias, means, sides
from ..base import AbstractMeanTally, State


class MatrixTally(AbstractMeanTally):
    """Reads counts; the last state's results are kept, since they are asked for more than once.

    Attributes:
        both_ways: use each line at both its ends, see `solve.of_both_ways`.
        directed: patches do not see what sees them, see `Factors.sent`.
    """

    def __init__(self, both_ways: bool, *, directed: bool = False):
        self.both_ways, self.directed = both_ways, directed
        self._last: tuple[np.ndarray | None, dict] = (None, {})

    def lines(self, problem: Problem, state: State) -> int:
        """Each line of a patch is an entry; a span between two patches is two."""
        return int(state["counts"].sum(dtype=np.uint64))

    def arrivals(self, problem: Problem, state: State) -> np.ndarray:
        n, (_, columns) = len(problem.patches), split(state["keys"])
        return np.bincount(columns, weights=state["counts"], minlength=n + 2)[:n].astype(np.int64)

    def irradiance(self, problem: Problem, state: State, group: int) -> tuple[np.ndarray, float]:
        return self._solved(problem, state, group)[0], 1.0

    def bias(self, problem: Problem, state: State, group: int) -> np.ndarray:
        """What patches without lines were given, and what patches get back of their own light, `solve.of_own_light`."""
        values, _, own = self._solved(problem, state, group)
        return bias(values, self.measured(problem, state)) + own.mean(axis=0)

    def measured(self, problem: Problem, state: State) -> np.ndarray:
        rows, _ = split(state["keys"])
        shape = (int(state["replicates"]), len(problem.patches))
        return np.bincount(rows, weights=state["counts"], minlength=shape[0] * shape[1]).reshape(shape)

    def line(self, problem: Problem, state: State, group: int) -> np.ndarray | float:
        """Of a patch's lines one meets the brightest light."""
        n, (rows, _) = len(problem.patches), split(state["keys"])
        each = np.bincount(rows % n, weights=state["counts"], minlength=n) / int(state["replicates"])
        return problem.groups.emission[:, group].max() * problem.patches.area / np.maximum(each, 1)

    def books(self, problem: Problem, state: State, group: int) -> dict:
        values, missed, _ = self._solved(problem, state, group)
        emitted = float(problem.groups.emission[:, group] @ problem.patches.area)
        absorbed = float(values.mean(axis=0) @ (1 - problem.groups.reflectance[:, group]))
        return by_difference(emitted, absorbed, *(float(x) for x in missed.mean(axis=0)))

    def _solved(self, problem: Problem, state: State, group: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Power received, (replicates, n_patches), escaped and lost, (replicates, 2), and how much too high the first may be."""
        if self._last[0] is not state["keys"]:
            self._last = state["keys"], self._all(problem, state)
        return self._last[1][group]

    def _all(self, problem: Problem, state: State) -> dict:
        groups, area, side = problem.groups, problem.patches.area, sides(problem.patches)
        found = {group: ([], [], []) for group in range(groups.n_groups)}
        measured = self.measured(problem, state)
        for lines, factors in zip(measured, replicate_factors(problem, state, both_ways=self.both_ways), strict=True):
            seen = factors.sent(area) if self.directed else factors
            fill = not self.directed and not lines.all()  # there, patches receive by lines of others

            def filled(received, lines=lines, fill=fill):
                return means(received * lines, lines, side) if fill else received

            for group, (values, missed, own) in found.items():
                emission, rho = groups.emission[:, group], groups.reflectance[:, group]
                received = irradiance(seen, emission, rho, filled)
                power = area * (emission + rho * received)
                values.append(area * received)
                missed.append([factors.escaped @ power, factors.lost @ power])
                more = of_own_light(seen, area, lines, emission, rho, received, both_ways=self.both_ways)
                own.append(area * more)
        return {group: tuple(np.array(column) for column in columns) for group, columns in found.items()}


def replicate_factors(problem: Problem, state: State, *, both_ways: bool) -> Iterator[Factors]:
    """The form factors of each replicate, one after the other."""
    n = len(problem.patches)
    bounds = np.searchsorted(state["keys"], np.arange(int(state["replicates"]) + 1).astype(np.uint64) * np.uint64(n) << WORD)
    for replicate, (begin, end) in enumerate(pairwise(bounds)):
        keys, counts = state["keys"][begin:end] - (np.uint64(replicate * n) << WORD), state["counts"][begin:end]
        yield of_both_ways(keys, counts, n, problem.patches.area) if both_ways else of_rows(keys, counts, n)


def form_factors(problem: Problem, state: State, labels: np.ndarray, *, both_ways: bool) -> np.ndarray:
    """(replicates, k, k) form factors between k groups of patches, and to nowhere, (replicates, k, k + 2): the last two columns
    are escaped and lost.

    Args:
        labels: (n_patches,) int, the group of each patch, 0 to k - 1.
    """
    area, k = problem.patches.area, int(labels.max()) + 1
    whole = np.bincount(labels, weights=area, minlength=k)
    result = []
    for factors in replicate_factors(problem, state, both_ways=both_ways):
        pairs = labels[factors.rows] * k + labels[factors.columns]
        power = np.bincount(pairs, weights=factors.values * area[factors.rows], minlength=k * k).reshape(k, k)
        missed = [np.bincount(labels, weights=x * area, minlength=k) for x in (factors.escaped, factors.lost)]
        result.append(np.column_stack([power, *missed]) / whole[:, None])
    return np.array(result)
