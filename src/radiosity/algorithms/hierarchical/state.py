"""The state of hierarchical radiosity after a round: links, and what they bring."""

from dataclasses import dataclass

import numpy as np

from ..alone import ALONE
from ..baseline_state import AbstractSolvedState
from ..state import Record, array, number, part


@dataclass(frozen=True, eq=False, kw_only=True)
class Kept(Record):
    """What the next round begins with.

    Attributes:
        receiver, source, factor, spread: of links, (m,) each, see `links.Links`.
        irradiance: (n_patches, n_bands) float64, W/m² or lm/m².
    """

    receiver: np.ndarray = array("any")
    source: np.ndarray = array("any")
    factor: np.ndarray = array("any")
    spread: np.ndarray = array("any")
    irradiance: np.ndarray = array("rows", "any")


@dataclass(frozen=True, eq=False, kw_only=True)
class HierarchicalState(AbstractSolvedState):
    """The numbers of complete rounds, and of links between elements after them; with what goes on from there.

    Attributes:
        kept: None in older files, from which no run goes on.
        indicated: (n_patches, n_bands) float64, errors of irradiance that links may add up to, W/m² or lm/m² (`indicated`); None
            before the last round is complete.
    """

    alone = ALONE["hierarchical"]

    rounds: int = number(int)
    links: int = number(int)
    kept: Kept | None = part(Kept, "link_", optional=True)
    indicated: np.ndarray | None = array("rows", "any", optional=True)

    @property
    def unfinished(self) -> bool:
        return self.rounds < self.quanta
