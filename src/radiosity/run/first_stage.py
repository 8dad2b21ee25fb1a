"""The first stage of a run: the ladder's first rung, or less where the budget asks for less."""

from dataclasses import dataclass

from ..algorithms.base import AbstractAlgorithm, Swept
from ..method import Baseline, Method
from .budget import Budget
from .pilot import few_quanta

MANY = 64  # more lines than a quantum takes in most scenes: then the first rung is within the budget
AT_ONCE = 1 << 24  # lines: a run of fewer, whose N is known beforehand, is one stage


def known_ladder(budget: Budget, algorithm: AbstractAlgorithm) -> Budget:
    """Return the budget, or N in its place where it is known, before any line is traced, how many lines N takes."""
    if budget.rays is None or budget.error is not None:
        return budget
    known = algorithm.quanta_for(budget.rays)
    return budget if known is None else Budget(quanta=known)


@dataclass(frozen=True)
class FirstStage:
    """What decides N of the first stage.

    Attributes:
        ladder: the budget that decides N of all stages, see `known_ladder`.
        budget: the one that was asked for.
        rung: the first one of the ladder.
        replicates: of the run.
    """

    ladder: Budget
    budget: Budget
    rung: int
    replicates: int

    def known(self, method: Method | Baseline, *, watched: bool) -> int | None:
        """Return N where it is known without a line; None where few lines must tell.

        Args:
            watched: True where someone watches the run, who wants more than one result.
        """
        if self.ladder.quanta is not None:
            known = int(self.ladder.quanta)
            at_once = not watched and self.ladder is not self.budget and known * self.replicates <= AT_ONCE
            return known if at_once else min(self.rung, known)
        rays = self.budget.rays
        enough = rays is None or rays >= MANY * self.rung * self.replicates
        return self.rung if enough or isinstance(method, Baseline) else None

    def tried(self, algorithm: AbstractAlgorithm, told: Swept) -> int:
        """Return N as few lines tell it.

        Args:
            algorithm: of one replicate; it cannot be used afterwards.
            told: is called while they are traced.
        """
        assert self.budget.rays is not None
        return min(self.rung, few_quanta(self.budget.rays, self.replicates, algorithm, told))
