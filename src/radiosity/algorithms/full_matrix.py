"""Full matrix radiosity: all form factors, then the equation.

C. M. Goral, K. E. Torrance, D. P. Greenberg and B. Battaile, "Modeling the interaction of light between diffuse surfaces",
SIGGRAPH 1984; with shadows, M. Cohen and D. Greenberg, "The hemi-cube", and T. Nishita and E. Nakamae, "Continuous tone
representation of three-dimensional objects taking account of shadows and interreflection", both SIGGRAPH 1985.
"""

import warnings

import numpy as np

from ..errors import MethodError, RadiosityWarning
from ..factors import solvers
from ..factors.balance import restored
from ..factors.model import Factors
from ..factors.polygons.matrix import exact
from ..factors.sources import rows_for
from ..sampling.streams import Seed
from . import estimate
from .base import AbstractAlgorithm, Swept
from .baseline_state import FullMatrixState, Solved
from .baseline_tally import SolvedTally
from .state import Arrays, Sizes


class FullMatrix(AbstractAlgorithm[FullMatrixState]):
    """Forms and solves the matrix of each replicate, one after the other, in one stage. No matrix is kept."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.rows = rows_for(self.geometry, self.problem, self.method, self.seed, self.replicates)
        halves = 2 if self.method.factors == "polygons" else 1
        times = self.replicates / halves
        estimate.full_matrix(self.rows, len(self.problem.patches), times, reciprocal=self.method.reciprocal).check()
        if self.replicates > 1 and self.method.factors == "hemicube":
            warnings.warn(
                "standard errors of hemicubes hold what turning them changes, not what all of them have in common: one point "
                "stands for a patch (docs/baselines.md says how much that is)",
                RadiosityWarning,
                stacklevel=7,
            )
        self.n, self.lines, self.solved = len(self.problem.patches), 0, []

    @property
    def quanta(self) -> int:
        return int(bool(self.solved))

    @property
    def stage_independent(self) -> bool:
        return True

    def advance(self, quanta: int, swept: Swept) -> None:
        while len(self.solved) < self.replicates:
            self.solved.append(self._solve(self._matrix(len(self.solved), swept)))

    def _matrix(self, replicate: int, swept: Swept) -> Factors:
        def counted(lines: int) -> None:
            self.lines += lines
            swept(lines)

        if self.method.factors == "polygons":  # each pair is computed once
            made = exact(self.geometry, self.method.lines_of_pair, Seed.of(self.seed).number_of(replicate), swept=counted)
        else:
            made = self.rows.make(np.arange(self.n), replicate, counted).factors
        area = self.problem.patches.area
        if self.method.reciprocal:
            if self.geometry.some_backs_pass:
                raise MethodError(
                    f"{self.problem.patches.scene.source}: some backs let lines pass, so what a patch sees is not what sees it, "
                    "and there is no reciprocity to restore; leave it out"
                )
            made = _symmetric(restored(made, area), area)
        return made.sent(area) if self.geometry.some_backs_pass else made

    def _solve(self, matrix: Factors) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return power received and missed, entries of each column, and the history of convergence."""
        groups, area = self.problem.groups, self.problem.patches.area
        system = solvers.System(
            matrix.sparse(self.n), groups.emission, groups.reflectance, area, through=groups.through, other=groups.other
        )
        found = solvers.solve(self.method.solver, system)
        received = area[:, None] * (system.factors @ found.radiosity)
        power = area[:, None] * found.radiosity
        missed = np.stack([matrix.escaped @ power, matrix.lost @ power])
        seen = np.bincount(matrix.columns, minlength=self.n)
        return received, missed, seen, np.column_stack([np.arange(len(found.history)) + 1, found.history])

    def capture(self) -> FullMatrixState:
        if len(self.solved) < self.replicates:
            return FullMatrixState(sizes=self.sizes, quanta=0)
        received, missed, seen, history = zip(*self.solved, strict=True)
        solved = Solved(
            sizes=self.sizes,
            done=True,
            lines=self.lines,
            received=np.array(received),
            missed=np.array(missed),
            seen=np.sum(seen, axis=0),
            history=history[0],
        )
        return FullMatrixState(sizes=self.sizes, quanta=1, solved=solved)

    def read(self, arrays: Arrays, sizes: Sizes) -> FullMatrixState:
        lacking = FullMatrixState.lacking(arrays, sizes, ("solved",))
        if lacking:
            raise MethodError(f"the solution lacks what its full matrix gave ({lacking}); solve it anew")
        return FullMatrixState.read(arrays, sizes)

    def restore(self, state: FullMatrixState) -> None:
        raise MethodError("a full matrix is made whole or not at all: there is nothing to go on from")

    @property
    def tally(self) -> SolvedTally:
        return SolvedTally()


def _symmetric(factors: Factors, area: np.ndarray) -> Factors:
    """Return factors with A_i F_ij = A_j F_ji up to rounding, which conjugate gradients need.

    Row sums change by as much as this was not so.
    """
    exchange = factors.values * area[factors.rows]
    order, other = (np.lexsort(keys) for keys in ((factors.columns, factors.rows), (factors.rows, factors.columns)))
    mean = np.empty_like(exchange)
    mean[order] = (exchange[order] + exchange[other]) / 2
    return Factors(factors.rows, factors.columns, mean / area[factors.rows], factors.escaped, factors.lost)
