"""The state of hierarchical radiosity after a round; links are not kept."""

from dataclasses import dataclass

from ..alone import ALONE
from ..baseline_state import AbstractSolvedState
from ..state import number


@dataclass(frozen=True, eq=False, kw_only=True)
class HierarchicalState(AbstractSolvedState):
    """The numbers of complete rounds, and of links between elements after them."""

    alone = ALONE["hierarchical"]

    rounds: int = number(int)
    links: int = number(int)

    @property
    def unfinished(self) -> bool:
        return self.rounds < self.quanta
