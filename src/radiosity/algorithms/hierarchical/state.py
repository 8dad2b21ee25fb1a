"""What hierarchical radiosity tells of a round; its links are not kept."""

from dataclasses import dataclass

from ..alone import ALONE
from ..baseline_state import AbstractSolvedState
from ..state import number


@dataclass(frozen=True, eq=False, kw_only=True)
class HierarchicalState(AbstractSolvedState):
    """Rounds of refinement made, and links between elements after them."""

    alone = ALONE["hierarchical"]

    rounds: int = number(int)
    links: int = number(int)

    @property
    def unfinished(self) -> bool:
        return self.rounds < self.quanta
