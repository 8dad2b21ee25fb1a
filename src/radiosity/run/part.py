"""Which replicates of a seed a run solves: all of them, or a part that is merged with others (`merge`)."""

from dataclasses import dataclass

from ..algorithms.alone import ALONE
from ..errors import MethodError
from ..method import Baseline, Method
from ..sampling.streams import Seed
from .budget import Budget, first_rung, stages

TOGETHER = "all replicates of a run make as many steps of {} as the one that needs most"


@dataclass(frozen=True)
class Part:
    """Replicates of a run.

    Attributes:
        seed: whose replicates, and the first of them.
        replicates: how many.
        in_all: how many all parts have together, where that is known.
    """

    seed: Seed
    replicates: int
    in_all: int | None = None

    def __post_init__(self):
        if self.in_all is not None and self.in_all < self.end:
            raise MethodError(
                f"all_replicates is {self.in_all}, and this run has replicates {self.range}; it must be {self.end} or more"
            )
        if self.in_all == self.replicates:  # the whole
            object.__setattr__(self, "in_all", None)

    @property
    def first(self) -> int:
        return self.seed.first_replicate

    @property
    def end(self) -> int:
        """The replicate after the last."""
        return self.first + self.replicates

    @property
    def range(self) -> str:
        """Return the name that people read."""
        return f"{self.first} to {self.end - 1}"

    def rung(self, order: str, share) -> int:
        """N of the first stage: that of one run with all replicates, where they are known."""
        return first_rung(order, self.in_all or self.replicates, share)

    def facts(self) -> dict:
        """Return what the provenance holds, without what is as in a whole run."""
        facts = {"seed": self.seed.value, "replicates": self.replicates}
        facts |= {"first_replicate": self.first} if self.first else {}
        return facts | ({} if self.in_all is None else {"all_replicates": self.in_all})

    def check(self, method: Method | Baseline, budget: Budget, rung: int) -> None:
        """Refuse a part whose replicates would be others than in one run with all of them.

        Raises:
            MethodError: the method, or this many stages of it.
        """
        reason = together(method)
        if isinstance(method, Method) and method.order == "incremental":
            several = budget.quanta is None or budget.quanta > rung
            reason = f"{reason}; with quanta={rung} or fewer there is one stage alone" if several else ""
        if reason and (self.first or self.in_all is not None):
            given = f"first_replicate={self.first}" if self.first else f"all_replicates={self.in_all}"
            raise MethodError(f"{given}: {method} cannot be solved in parts, since {reason}; solve all replicates in one run")


def together(method: Method | Baseline) -> str:
    """Return why all replicates of a method advance together; "" where each can be solved alone."""
    if isinstance(method, Method) and method.machine == "iteration":
        if method.warm_up:
            return TOGETHER.format("a warm-up")
        if method.order == "incremental":
            return TOGETHER.format("a stage")
    if isinstance(method, Method) and method.coherent:
        return "what a line meets where faces touch depends on the lines beside it"
    return ALONE.get(method.machine, "")


def check_stages(method: Method | Baseline, quanta: int, rung: int, parts: list[tuple[Part, int]]) -> None:
    """Refuse parts that climbed other stages than the whole run does, where results depend on them.

    Args:
        rung: N of the first stage of the whole run.
        parts: and of each part.
    """
    in_all = sum(part.replicates for part, _ in parts)
    for part, its_rung in parts:
        if stages(quanta, its_rung) != stages(quanta, rung):
            raise MethodError(
                f"cannot merge: results of {method} depend on stages, and those of replicates {part.range} begin at {its_rung} "
                f"quanta, those of a run of all {in_all} at {rung}; solve each part with all_replicates={in_all}"
            )
    if isinstance(method, Method) and method.order == "incremental" and len(stages(quanta, rung)) > 1:
        raise MethodError(
            f"cannot merge {method} at {quanta} quanta: {TOGETHER.format('a stage')}; take quanta={rung} or fewer, or one run"
        )
