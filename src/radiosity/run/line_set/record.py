"""The record of a run that only counts lines: its results are line sets."""

from dataclasses import dataclass
from typing import ClassVar

from ...algorithms.matrix.state import MatrixState
from ...algorithms.state import AbstractState
from ...factors.counted import CountedPairs
from ...method import Method
from ...solution.npz import LINES
from ..record import AbstractRecord
from ..snapshot import Snapshot
from .model import LineSet
from .problem import some_backs_pass


@dataclass(frozen=True, eq=False)
class LineRecord(AbstractRecord[LineSet]):
    """Makes line sets of the states of the matrix method. A state within a stage is that of a run with fewer lines.

    Attributes:
        sources: names of the surfaces that get more lines.
        both_ways: lines count at both ends, where they may.
    """

    sources: tuple[str, ...] = ()
    both_ways: bool = True
    kind: ClassVar[str] = LINES
    has_errors: ClassVar[bool] = False

    @property
    def provenance(self) -> dict:
        scene = self.patches.scene
        what = {"geometry": scene.geometry_hash, "source": scene.source, "sources": list(self.sources)}
        return what | self._run | {"cut": self.patches.cut_hash}

    def result(self, snapshot: Snapshot, status: str, state: AbstractState, seconds: float) -> LineSet:
        return self.unfinished(None, status, state, seconds)

    def unfinished(self, before: LineSet | None, status: str, state: AbstractState, seconds: float) -> LineSet:
        assert isinstance(state, MatrixState)
        assert isinstance(self.method, Method)
        directed = some_backs_pass(self.patches)
        both = self.both_ways and self.method.lines == "local" and not directed
        pairs = CountedPairs(self.patches.solid, state.keys, state.counts, state.replicates, both, directed, keeps=True)
        rays, parts = int(state.counts.sum(dtype="u8")), (self.part,)
        return LineSet(pairs, rays, state.reached, seconds, status, self.method, parts, self.sources, self.provenance)
